#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>
#include <vector>

#include "tests/firmware/temporary_folder.hpp"

namespace compueye::test {

/// An X server without a monitor (Xvfb), whose screen lies in a file (the format of xwd) that is read back. The display
/// of this process while it lives.
class VirtualScreen {
 public:
  static constexpr int width = 320, height = 200;

  VirtualScreen();
  VirtualScreen(const VirtualScreen&) = delete;
  VirtualScreen& operator=(const VirtualScreen&) = delete;
  ~VirtualScreen();

  /// Why there is none; empty: it runs.
  [[nodiscard]] const std::string& missing() const noexcept { return missing_; }
  /// width x height, 0xRRGGBB, row 0 on top.
  [[nodiscard]] std::vector<std::uint32_t> pixels() const;

 private:
  TemporaryFolder folder_;
  pid_t server_ = -1;
  std::string missing_;
};

}  // namespace compueye::test
