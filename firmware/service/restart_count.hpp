#pragma once

#include <cstdint>
#include <string>

#include "hal/result.hpp"

namespace compueye::firmware {

/// How often in a row a service failed, in a file of its runtime folder, which outlives it (RuntimeDirectoryPreserve).
/// A start counts as failed until it has gone well: what is killed cannot count itself.
class RestartCount {
 public:
  /// `folder`: RUNTIME_DIRECTORY; empty: nothing is counted.
  explicit RestartCount(std::string folder);
  /// Of the service manager that started this program.
  [[nodiscard]] static RestartCount of_environment();

  /// How often it failed before this start, which is counted as another time. Errors: io, no_space.
  [[nodiscard]] hal::Result<std::uint64_t> begin();
  /// It went well, or was asked to end.
  [[nodiscard]] hal::Result<void> forget();

 private:
  [[nodiscard]] hal::Result<void> write(std::uint64_t failures) const;
  std::string file_;
};

}  // namespace compueye::firmware
