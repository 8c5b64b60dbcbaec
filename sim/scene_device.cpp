#include "sim/scene_device.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

namespace compueye::sim {

protocol::SampleGenerator samples_of(std::shared_ptr<Simulation> simulation) {
  return [seen = std::move(simulation)](const protocol::EmulatedExposure& exposure, std::span<std::int32_t> codes) {
    static_cast<void>(seen->codes(exposure.frame, codes));
  };
}

protocol::DeviceDescriptor describe_device(const EyeToSimulate& board, const std::string& serial) {
  constexpr std::uint32_t second_ns = 1'000'000'000;
  protocol::DeviceDescriptor descriptor;
  descriptor.serial = serial;
  descriptor.firmware = "simulated";
  descriptor.channels = board.eye.ommatidia();
  descriptor.bits = board.sensor.bits;
  for (const auto format : {protocol::SampleFormat::u12, protocol::SampleFormat::u16, protocol::SampleFormat::i24}) {
    if (protocol::most_bits(format) >= descriptor.bits) descriptor.formats.push_back(format);
  }
  descriptor.least_frame_rate_mhz = 1;
  descriptor.most_frame_rate_mhz = std::numeric_limits<std::uint32_t>::max();
  descriptor.most_exposure_ns = second_ns;
  const auto channels = static_cast<std::size_t>(descriptor.channels);
  descriptor.ommatidium_of_channel.resize(channels);
  std::iota(descriptor.ommatidium_of_channel.begin(), descriptor.ommatidium_of_channel.end(), 0);
  descriptor.sample_offset_ns.assign(channels, 0);
  for (int m = 0; m < descriptor.channels; ++m) {
    const double offset_ns = board.detector.slot(m, descriptor.channels) * board.detector.mux_slot_us * 1e3;
    descriptor.sample_offset_ns[static_cast<std::size_t>(m)] =
        static_cast<std::int32_t>(std::min(offset_ns, double{protocol::DeviceDescriptor::most_offset_ns}));
  }
  return descriptor;
}

}  // namespace compueye::sim
