#include "drivers/device/device_requests.hpp"

#include <algorithm>
#include <array>

#include "drivers/protocol/little_endian.hpp"
#include "hal/try.hpp"

namespace compueye::device {

using protocol::Request;

hal::Result<std::size_t> DeviceRequests::request(Request request, std::span<const std::byte> payload,
                                                 std::span<std::byte> reply, std::int64_t until_ns) {
  const std::int64_t own_ns = clock_.now_ns() + protocol::control_deadline_ns;
  auto got = transport_.control(protocol::number(request), payload, reply, std::min(own_ns, until_ns));
  cut_short_ = !got && got.error().code == hal::ErrorCode::timeout && until_ns < own_ns;
  return got;
}

hal::Result<void> DeviceRequests::order(Request what, std::int64_t until_ns) {
  return request(what, {}, {}, until_ns).map([](std::size_t) {});
}

hal::Result<protocol::PingReply> DeviceRequests::ping(std::int64_t until_ns) {
  std::array<std::byte, 4> nonce{};
  protocol::store_little(nonce.data(), ++nonce_);
  std::array<std::byte, protocol::PingReply::bytes> reply{};
  const auto got = TRY(request(Request::ping, nonce, reply, until_ns));
  return protocol::parse_ping(std::span(reply).first(std::min(got, reply.size())), nonce_, transport_.describe().bus);
}

hal::Result<protocol::Status> DeviceRequests::status(std::int64_t until_ns) {
  std::array<std::byte, protocol::Status::bytes> reply{};
  const auto got = TRY(request(Request::status, {}, reply, until_ns));
  return protocol::parse_status(std::span(reply).first(std::min(got, reply.size())), transport_.describe().bus);
}

hal::Result<void> DeviceRequests::page(protocol::DescriptorPages& pages, std::int64_t until_ns) {
  std::array<std::byte, protocol::most_control_bytes> page{};
  const auto into = std::span(page).first(std::min(pages.reply_bytes(), page.size()));
  const auto got = TRY(request(Request::get_desc, pages.request(), into, until_ns));
  return pages.accept(into.first(std::min(got, into.size())));
}

hal::Result<void> DeviceRequests::set_configuration(const protocol::Configuration& wanted, std::int64_t until_ns) {
  std::array<std::byte, protocol::Configuration::bytes> bytes{};
  protocol::store(wanted, bytes);
  return request(Request::set_config, bytes, {}, until_ns).map([](std::size_t) {});
}

hal::Result<void> DeviceRequests::set_illumination(const protocol::Illumination& wanted, std::int64_t until_ns) {
  std::array<std::byte, protocol::Illumination::bytes> bytes{};
  protocol::store(wanted, bytes);
  return request(Request::set_illum, bytes, {}, until_ns).map([](std::size_t) {});
}

hal::Result<void> DeviceRequests::check_configuration(const protocol::Configuration& wanted, std::string_view serial,
                                                      std::int64_t until_ns) {
  std::array<std::byte, protocol::Configuration::bytes> echo{};
  const auto got = TRY(request(Request::get_config, {}, echo, until_ns));
  return protocol::check_echo(wanted, std::span(echo).first(std::min(got, echo.size())), serial);
}

}  // namespace compueye::device
