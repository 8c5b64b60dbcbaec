#pragma once

#include <cstdint>

#include "drivers/protocol/configuration.hpp"
#include "drivers/protocol/descriptor.hpp"
#include "hal/result.hpp"

namespace compueye::device {

/// What of an eye on a cable can be set beside its frames, and what it says of itself. For the thread that reads.
class EyeControls {
 public:
  EyeControls() = default;
  EyeControls(const EyeControls&) = delete;
  EyeControls& operator=(const EyeControls&) = delete;
  virtual ~EyeControls() = default;

  [[nodiscard]] virtual const protocol::DeviceDescriptor& descriptor() const noexcept = 0;
  [[nodiscard]] virtual std::int64_t exposure_ns() const noexcept = 0;
  /// For the runs from the next start() on; 0: as long as device and rate allow. Errors: usage (it is started),
  /// out_of_range.
  [[nodiscard]] virtual hal::Result<void> set_exposure(std::int64_t exposure_ns) = 0;
  /// SET_ILLUM, now; a device that starts anew forgets it. Errors: disconnected (or it is being got back: read() does
  /// that), timeout, io (refused).
  [[nodiscard]] virtual hal::Result<void> set_illumination(const protocol::Illumination& wanted) = 0;
};

}  // namespace compueye::device
