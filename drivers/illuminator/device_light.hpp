#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "drivers/protocol/configuration.hpp"
#include "drivers/protocol/descriptor.hpp"
#include "hal/clock.hpp"
#include "hal/illuminator.hpp"

namespace compueye::illuminator {

/// Carries out a SET_ILLUM, whatever happens to the device meanwhile.
using SetIllumination = std::function<hal::Result<void>(const protocol::Illumination&)>;

/// Lamps of the eye's own device as the pixels of a picture, in the descriptor's order: an LED each, row 0 on top.
/// SET_ILLUM gives one level to one lamp, so a picture takes a request for each lamp; all are set anew every time,
/// since a device that has started anew meanwhile has them off.
class DeviceLight final : public hal::Illuminator {
 public:
  /// `clock` must outlive it. Error unsupported (at `serial`): the device has not exactly rows x cols lamps.
  [[nodiscard]] static hal::Result<std::unique_ptr<DeviceLight>> create(const protocol::DeviceDescriptor& device,
                                                                        int rows, int cols, SetIllumination set,
                                                                        hal::Clock& clock);

  [[nodiscard]] const hal::IlluminatorDescription& describe() const noexcept override { return description_; }
  /// Errors: those of SetIllumination; mismatch (not as many intensities as pixels).
  [[nodiscard]] hal::Result<std::int64_t> show(std::span<const float> intensities) override;
  [[nodiscard]] hal::Result<std::int64_t> off() override;

 private:
  DeviceLight(std::vector<protocol::IlluminatorEntry> lamps, int rows, int cols, SetIllumination set,
              hal::Clock& clock);
  void next_tag() noexcept;

  std::vector<protocol::IlluminatorEntry> lamps_;
  SetIllumination set_;
  hal::Clock& clock_;
  hal::IlluminatorDescription description_;
  std::uint8_t tag_ = 0;
};

}  // namespace compueye::illuminator
