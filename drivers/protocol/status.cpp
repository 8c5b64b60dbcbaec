#include "drivers/protocol/status.hpp"

#include <algorithm>
#include <string>

#include "drivers/protocol/little_endian.hpp"

namespace compueye::protocol {
namespace {

tl::unexpected<hal::Error> too_short(std::string_view place, const char* what, std::size_t got, std::size_t expected) {
  return hal::fail(hal::ErrorCode::bad_format, std::string(place),
                   std::string("the reply to ") + what + " has " + std::to_string(got) + " bytes, expected " +
                       std::to_string(expected));
}

}  // namespace

void store(const Status& status, std::span<std::byte, Status::bytes> bytes) noexcept {
  std::byte* const at = bytes.data();
  store_little(at, static_cast<std::uint8_t>(status.state));
  store_little(at + 1, status.version.byte());
  store_little(at + 2, status.illum);
  store_little(at + 3, static_cast<std::uint8_t>(status.last_error));
  store_little(at + 4, status.config_id);
  store_little(at + 8, status.boot_count);
  store_little(at + 12, status.temperature);
  store_little(at + 14, status.fifo_permille);
  store_little(at + 16, status.frames);
  store_little(at + 20, status.overruns);
  store_little(at + 24, status.packets);
  store_little(at + 28, status.refused_requests);
  store_little(at + 32, status.now_ns);
  store_little(at + 40, status.last_t_ns);
}

hal::Result<Status> parse_status(std::span<const std::byte> bytes, std::string_view place) {
  if (bytes.size() < Status::bytes) return too_short(place, "STATUS", bytes.size(), Status::bytes);
  const std::byte* const at = bytes.data();
  const auto state = load_little<std::uint8_t>(at);
  if (state > static_cast<std::uint8_t>(DeviceState::streaming)) {
    return hal::fail(hal::ErrorCode::bad_format, std::string(place),
                     "the device says that it is in state " + std::to_string(state) + ", expected 0 to 2");
  }
  Status status;
  status.state = static_cast<DeviceState>(state);
  status.version = ProtocolVersion::from_byte(load_little<std::uint8_t>(at + 1));
  status.illum = load_little<std::uint8_t>(at + 2);
  status.last_error = static_cast<StatusError>(load_little<std::uint8_t>(at + 3));
  status.config_id = load_little<std::uint32_t>(at + 4);
  status.boot_count = load_little<std::uint32_t>(at + 8);
  status.temperature = load_little<std::int16_t>(at + 12);
  status.fifo_permille = load_little<std::uint16_t>(at + 14);
  status.frames = load_little<std::uint32_t>(at + 16);
  status.overruns = load_little<std::uint32_t>(at + 20);
  status.packets = load_little<std::uint32_t>(at + 24);
  status.refused_requests = load_little<std::uint32_t>(at + 28);
  status.now_ns = load_little<std::uint64_t>(at + 32);
  status.last_t_ns = load_little<std::uint64_t>(at + 40);
  return status;
}

void store(const PingReply& reply, std::span<std::byte, PingReply::bytes> bytes) noexcept {
  std::fill(bytes.begin(), bytes.end(), std::byte{0});
  store_little(bytes.data(), reply.nonce);
  store_little(bytes.data() + 4, reply.version.byte());
  store_little(bytes.data() + 5, static_cast<std::uint8_t>(reply.state));
}

hal::Result<PingReply> parse_ping(std::span<const std::byte> bytes, std::uint32_t nonce, std::string_view place) {
  if (bytes.size() < PingReply::bytes) return too_short(place, "PING", bytes.size(), PingReply::bytes);
  const auto got = load_little<std::uint32_t>(bytes.data());
  if (got != nonce) {
    return hal::fail(hal::ErrorCode::mismatch, std::string(place),
                     "PING " + std::to_string(nonce) + " was answered with " + std::to_string(got) +
                         ": the answer to another request; reset the control channel");
  }
  return PingReply{got, ProtocolVersion::from_byte(load_little<std::uint8_t>(bytes.data() + 4)),
                   static_cast<DeviceState>(load_little<std::uint8_t>(bytes.data() + 5))};
}

}  // namespace compueye::protocol
