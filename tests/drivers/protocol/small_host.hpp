#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "drivers/protocol/descriptor_pages.hpp"
#include "drivers/protocol/device_emulator.hpp"
#include "drivers/protocol/frame_assembler.hpp"
#include "drivers/protocol/hid_assembler.hpp"
#include "drivers/protocol/requests.hpp"
#include "hal/byte_transport.hpp"
#include "hal/clock.hpp"

namespace compueye::protocol::tests {

/// What an emulated eye shows: a code that tells frame and channel.
inline std::int32_t shown_code(std::uint64_t frame, std::size_t channel, int bits) {
  return static_cast<std::int32_t>((frame * 7919 + channel * 31) & ((1U << bits) - 1U));
}

inline SampleGenerator shown(int bits) {
  return [bits](const EmulatedExposure& exposure, std::span<std::int32_t> codes) {
    for (std::size_t k = 0; k < codes.size(); ++k) codes[k] = shown_code(exposure.frame, k, bits);
  };
}

/// The smallest host that can talk to an eye over any transport: no retries, no recovery, so that a test sees the
/// device and the transport themselves.
class SmallHost {
 public:
  static constexpr std::int64_t second = 1'000'000'000;

  /// The eye is one that shows `shown(bits)`. Transport and clock must outlive the host and may be made after it.
  SmallHost(hal::ByteTransport& line, hal::Clock& time, const Bus* bus, const DeviceDescriptor& descriptor)
      : bits(descriptor.bits),
        channels(descriptor.channels),
        stream(descriptor.packet_limits()),
        packets(channels, bits),
        reports(channels, std::min(bits, hid_bits)),
        line_(line),
        time_(time),
        bus_(bus),
        chunk_(bus == &hid_bus ? hid_report_bytes : 16384) {}

  hal::Result<std::size_t> request(Request request, std::span<const std::byte> payload = {},
                                   std::span<std::byte> reply = {}) {
    return line_.control(number(request), payload, reply, time_.now_ns() + request_ns);
  }
  hal::Result<DeviceDescriptor> identify() {
    DescriptorPages pages(bus_->page_bytes, line_.describe().bus);
    std::vector<std::byte> page(bus_->page_bytes);
    while (!pages.complete()) {
      const auto got = request(Request::get_desc, pages.request(), std::span(page).first(pages.reply_bytes()));
      if (!got) return tl::unexpected(got.error());
      if (auto accepted = pages.accept(std::span(page).first(*got)); !accepted) return tl::unexpected(accepted.error());
    }
    return parse_descriptor(pages.bytes(), line_.describe().bus);
  }
  hal::Result<Status> status() {
    std::array<std::byte, Status::bytes> reply{};
    const auto got = request(Request::status, {}, reply);
    if (!got) return tl::unexpected(got.error());
    return parse_status(std::span(reply).first(*got), "eye");
  }
  hal::Result<void> configure(const Configuration& wanted) {
    std::array<std::byte, Configuration::bytes> bytes{}, echo{};
    store(wanted, bytes);
    if (auto set = request(Request::set_config, bytes); !set) return tl::unexpected(set.error());
    const auto got = request(Request::get_config, {}, echo);
    if (!got) return tl::unexpected(got.error());
    return check_echo(wanted, std::span(echo).first(*got), "eye");
  }
  [[nodiscard]] Configuration wanted() const {
    return {next_config_id_, frame_rate_mhz, 1'000'000, is_hid() || bits <= 12 ? SampleFormat::u12 : SampleFormat::u16};
  }
  /// Opens, configures with a new id and starts; frame numbers go on. For HID the time of the frames is asked for.
  hal::Result<void> start() {
    if (auto opened = line_.open(); !opened) return opened;
    return restart();
  }
  /// The same on a transport that is open.
  hal::Result<void> restart() {
    if (auto stopped = request(Request::reset_pipes); !stopped) return tl::unexpected(stopped.error());
    const Configuration configuration = wanted();
    ++next_config_id_;
    if (auto configured = configure(configuration); !configured) return configured;
    stream.reset();
    if (!begun_) packets.begin_run(), reports.begin_run();
    begun_ = true;
    packets.begin_stream(configuration.config_id, configuration.period_ns());
    reports.begin_stream(configuration.config_id, configuration.period_ns());
    const auto started = request(Request::start);
    return started.map([](std::size_t) {});
  }

  /// The next frame, or why there is none by `deadline_ns`.
  hal::Result<hal::SampleBlock> frame(std::int64_t deadline_ns) {
    for (;;) {
      if (const auto block = is_hid() ? reports.take() : packets.take()) return *block;
      if (!is_hid()) {
        if (const auto packet = stream.next()) {
          packets.push(*packet);
          continue;
        }
      }
      const auto got = line_.read(chunk_, deadline_ns);
      if (!got) return tl::unexpected(got.error());
      const auto bytes = std::span<const std::byte>(chunk_).first(*got);
      is_hid() ? reports.push(bytes) : stream.feed(bytes);
    }
  }
  hal::Result<hal::SampleBlock> frame() { return frame(time_.now_ns() + frame_ns); }

  /// Whether the valid samples of a block are those shown in frame `device_frame`.
  [[nodiscard]] bool right(const hal::SampleBlock& block, std::uint64_t device_frame) const {
    for (std::size_t k = 0; k < block.codes.size(); ++k) {
      if (block.valid[k] != 0 && block.codes[k] != shown_code(device_frame, k, bits)) return false;
    }
    return true;
  }

  [[nodiscard]] bool is_hid() const { return bus_ == &hid_bus; }
  [[nodiscard]] const hal::FrameAccount& account() const { return is_hid() ? reports.account() : packets.account(); }

  int bits, channels;
  std::uint32_t frame_rate_mhz = 100'000;
  std::int64_t request_ns = control_deadline_ns;  ///< how long a request may take
  std::int64_t frame_ns = second;                 ///< how long a frame is waited for
  PacketStream stream;
  FrameAssembler packets;
  HidAssembler reports;

 private:
  hal::ByteTransport& line_;
  hal::Clock& time_;
  const Bus* bus_;
  std::vector<std::byte> chunk_;
  std::uint32_t next_config_id_ = 1;
  bool begun_ = false;
};

}  // namespace compueye::protocol::tests
