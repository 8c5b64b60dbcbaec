#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <span>
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
  /// 0xRRGGBB, row 0 on top.
  [[nodiscard]] std::uint32_t pixel(int x, int y) const;
  /// 0..255, in the middle of square n of rows x cols, as large as the screen has room for and in its middle.
  [[nodiscard]] std::uint32_t level_of_square(std::size_t n, int rows, int cols) const;
  /// All of them, row after row.
  [[nodiscard]] std::vector<std::uint32_t> pixels() const;

 private:
  void look_at_file();

  TemporaryFolder folder_;
  std::span<const unsigned char> bytes_;  // of the mapped file
  std::size_t first_ = 0, line_ = 0;      // byte of the first pixel, bytes from line to line
  bool high_first_ = false;
  pid_t server_ = -1;
  std::string missing_;
};

}  // namespace compueye::test
