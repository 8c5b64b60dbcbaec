#include "drivers/protocol/bus.hpp"

#include <algorithm>

#include "drivers/protocol/frame_header.hpp"
#include "drivers/protocol/packet_encoder.hpp"

namespace compueye::protocol {

FrameSize frame_size(const Bus& bus, const DeviceDescriptor& device, SampleFormat format) noexcept {
  if (bus.framing == Framing::reports) {
    const auto parts = static_cast<std::size_t>(hid_parts(device.channels));
    return {parts, parts * bus.report_bytes};
  }
  constexpr std::size_t most_padding = 2;  // of samples that do not fill their last byte
  const auto channels = static_cast<std::size_t>(device.channels);
  const auto in_packet = static_cast<std::size_t>(std::max(channels_in(format, device.most_payload), 1));
  const std::size_t packets = (channels + in_packet - 1) / in_packet;
  return {packets, packed_bytes(format, channels) + packets * (least_packet_bytes + most_padding)};
}

}  // namespace compueye::protocol
