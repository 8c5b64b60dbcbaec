#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "drivers/device/device_source.hpp"
#include "drivers/device/eye_controls.hpp"
#include "drivers/device/hang_proof_source.hpp"

namespace compueye::device {

/// A DeviceSource that can hold nobody up, and what can be set of it.
class HangProofEye final : public HangProofSource, public EyeControls {
 public:
  using OpenEye = std::function<hal::Result<std::unique_ptr<DeviceSource>>(hal::Clock& clock)>;

  /// As HangProofSource::create().
  [[nodiscard]] static hal::Result<std::unique_ptr<HangProofEye>> create(std::string device, OpenEye open,
                                                                         SharedTime time = SharedTime::monotonic(),
                                                                         std::size_t frames_ahead = usual_ahead);

  [[nodiscard]] const protocol::DeviceDescriptor& descriptor() const noexcept override { return descriptor_; }
  [[nodiscard]] std::int64_t exposure_ns() const noexcept override { return exposure_ns_; }
  /// Error timeout besides, as the other: it hangs.
  [[nodiscard]] hal::Result<void> set_exposure(std::int64_t exposure_ns) override;
  [[nodiscard]] hal::Result<void> set_illumination(const protocol::Illumination& wanted) override;

 private:
  using HangProofSource::HangProofSource;

  /// What an act may leave behind outlives this.
  struct Told {
    protocol::DeviceDescriptor descriptor;
    std::int64_t exposure_ns = 0;
  };

  protocol::DeviceDescriptor descriptor_;
  std::int64_t exposure_ns_ = 0;
};

}  // namespace compueye::device
