#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "drivers/protocol/configuration.hpp"
#include "drivers/protocol/descriptor_pages.hpp"
#include "drivers/protocol/requests.hpp"
#include "drivers/protocol/status.hpp"
#include "hal/byte_transport.hpp"
#include "hal/clock.hpp"
#include "hal/result.hpp"

namespace compueye::device {

/// The requests of docs/protocol.md over a transport. Each waits until `until_ns`, but no longer than a device may take
/// (protocol::control_deadline_ns). Errors: those of hal::ByteTransport::control(), and bad_format for a reply that is
/// none.
class DeviceRequests {
 public:
  /// Both must outlive this.
  DeviceRequests(hal::ByteTransport& transport, hal::Clock& clock) noexcept : transport_(transport), clock_(clock) {}

  /// One without payload and reply: START, STOP, RESET_PIPES.
  [[nodiscard]] hal::Result<void> order(protocol::Request what, std::int64_t until_ns);
  /// The same in every version of the protocol, which is not judged.
  [[nodiscard]] hal::Result<protocol::PingReply> ping(std::int64_t until_ns);
  [[nodiscard]] hal::Result<protocol::Status> status(std::int64_t until_ns);
  /// Fetches the next page. Errors besides: unsupported (another protocol version).
  [[nodiscard]] hal::Result<void> page(protocol::DescriptorPages& pages, std::int64_t until_ns);
  [[nodiscard]] hal::Result<void> set_configuration(const protocol::Configuration& wanted, std::int64_t until_ns);
  [[nodiscard]] hal::Result<void> set_illumination(const protocol::Illumination& wanted, std::int64_t until_ns);
  /// Errors besides: mismatch (another configuration came back). `serial`: for errors.
  [[nodiscard]] hal::Result<void> check_configuration(const protocol::Configuration& wanted, std::string_view serial,
                                                      std::int64_t until_ns);

  /// The last request timed out at `until_ns`, before the device's own time was up: nothing to blame it for.
  [[nodiscard]] bool cut_short() const noexcept { return cut_short_; }

 private:
  [[nodiscard]] hal::Result<std::size_t> request(protocol::Request request, std::span<const std::byte> payload,
                                                 std::span<std::byte> reply, std::int64_t until_ns);

  hal::ByteTransport& transport_;
  hal::Clock& clock_;
  std::uint32_t nonce_ = 0;
  bool cut_short_ = false;
};

}  // namespace compueye::device
