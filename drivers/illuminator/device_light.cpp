#include "drivers/illuminator/device_light.hpp"

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

#include "drivers/illuminator/grey_levels.hpp"
#include "drivers/protocol/frame_header.hpp"
#include "hal/try.hpp"

namespace compueye::illuminator {

hal::Result<std::unique_ptr<DeviceLight>> DeviceLight::create(const protocol::DeviceDescriptor& device, int rows,
                                                              int cols, SetIllumination set, hal::Clock& clock) {
  std::vector<protocol::IlluminatorEntry> lamps;
  std::copy_if(device.illuminators.begin(), device.illuminators.end(), std::back_inserter(lamps),
               [](const auto& each) { return each.kind == protocol::IlluminatorKind::lamp; });
  const std::int64_t pixels = std::int64_t{rows} * cols;
  if (lamps.empty() || static_cast<std::int64_t>(lamps.size()) != pixels) {
    return hal::fail(hal::ErrorCode::unsupported, device.serial,
                     "has " + std::to_string(lamps.size()) + " lamps, expected " + std::to_string(pixels) +
                         ", one for each pixel of the board's object plane; take a display instead");
  }
  return std::unique_ptr<DeviceLight>(new DeviceLight(std::move(lamps), rows, cols, std::move(set), clock));
}

DeviceLight::DeviceLight(std::vector<protocol::IlluminatorEntry> lamps, int rows, int cols, SetIllumination set,
                         hal::Clock& clock)
    : lamps_(std::move(lamps)), set_(std::move(set)), clock_(clock) {
  description_ = {rows, cols, lamps_.front().levels, 0};
  for (const protocol::IlluminatorEntry& lamp : lamps_) {
    description_.levels = std::min<int>(description_.levels, lamp.levels);
    description_.settle_ns = std::max<std::int64_t>(description_.settle_ns, lamp.settle_ns);
  }
}

/// Never that of a light that is changing.
void DeviceLight::next_tag() noexcept {
  ++tag_;
  if (tag_ == protocol::illumination_changing) tag_ = 0;
}

hal::Result<std::int64_t> DeviceLight::show(std::span<const float> intensities) {
  TRY(check_size(description_, intensities, "lamps"));
  next_tag();
  for (std::size_t k = 0; k < lamps_.size(); ++k) {
    protocol::Illumination wanted;
    wanted.illuminator = lamps_[k].id;
    wanted.tag = tag_;
    wanted.level = static_cast<std::uint16_t>(level_of(intensities[k], lamps_[k].levels));
    TRY(set_(wanted));
  }
  return clock_.now_ns() + description_.settle_ns;
}

hal::Result<std::int64_t> DeviceLight::off() {
  const std::vector<float> none(lamps_.size(), 0.0F);
  return show(none);
}

}  // namespace compueye::illuminator
