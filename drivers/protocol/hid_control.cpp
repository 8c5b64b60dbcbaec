#include "drivers/protocol/hid_control.hpp"

#include <algorithm>
#include <optional>
#include <string>

#include "drivers/protocol/configuration.hpp"
#include "drivers/protocol/descriptor_pages.hpp"
#include "drivers/protocol/little_endian.hpp"
#include "drivers/protocol/requests.hpp"
#include "drivers/protocol/status.hpp"

namespace compueye::protocol {
namespace {

/// How one request looks on HID.
struct Shape {
  std::size_t payload_bytes = 0;
  std::optional<HidFeature> set, get;
  std::size_t set_at = 1;       // where the payload lies in the SET report
  std::size_t reply_at = 1;     // where the reply lies in the GET report
  std::size_t reply_bytes = 0;  // the most there are
};

std::optional<Shape> shape_of(std::uint8_t request) {
  switch (static_cast<Request>(request)) {
    case Request::get_desc:
      return Shape{PageRequest::bytes, HidFeature::descriptor, HidFeature::descriptor, 1, 4, hid_page_bytes};
    case Request::set_config:
      return Shape{Configuration::bytes, HidFeature::configuration, std::nullopt, 2, 0, 0};
    case Request::get_config:
      return Shape{0, std::nullopt, HidFeature::configuration, 0, 2, Configuration::bytes};
    case Request::start:
    case Request::stop:
    case Request::reset_pipes:
      return Shape{0, HidFeature::configuration, std::nullopt, 2, 0, 0};
    case Request::set_illum:
      return Shape{Illumination::bytes, HidFeature::illumination, std::nullopt, 1, 0, 0};
    case Request::status:
      return Shape{0, std::nullopt, HidFeature::counters, 0, 1 + PingReply::bytes, Status::bytes};
    case Request::ping:
      return Shape{4, HidFeature::counters, HidFeature::counters, 1, 1, PingReply::bytes};
  }
  return std::nullopt;
}

tl::unexpected<hal::Error> bad(std::string sentence) {
  return hal::fail(hal::ErrorCode::bad_format, "hid", std::move(sentence));
}

}  // namespace

hal::Result<HidExchange> hid_exchange(std::uint8_t request, std::span<const std::byte> payload,
                                      std::size_t reply_bytes) {
  const auto shape = shape_of(request);
  if (!shape) {
    return hal::fail(hal::ErrorCode::unsupported, "hid",
                     "request " + std::to_string(request) + " has no feature report; see docs/protocol.md");
  }
  if (payload.size() != shape->payload_bytes || shape->get.has_value() != (reply_bytes > 0)) {
    return hal::fail(hal::ErrorCode::usage, "hid",
                     "request " + std::to_string(request) + " was given " + std::to_string(payload.size()) +
                         " bytes of payload, expected " + std::to_string(shape->payload_bytes) +
                         (shape->get ? " and a reply" : " and no reply"));
  }
  HidExchange exchange;
  if (shape->set) {
    exchange.has_set = true;
    exchange.set[0] = static_cast<std::byte>(*shape->set);
    if (*shape->set == HidFeature::configuration) exchange.set[1] = static_cast<std::byte>(request);
    std::copy(payload.begin(), payload.end(), exchange.set.begin() + static_cast<std::ptrdiff_t>(shape->set_at));
  }
  if (shape->get) {
    exchange.has_get = true;
    exchange.get = *shape->get;
  }
  return exchange;
}

hal::Result<std::size_t> hid_reply(std::uint8_t request, std::span<const std::byte> payload,
                                   std::span<const std::byte> report, std::span<std::byte> reply) {
  const auto shape = shape_of(request);
  if (!shape || !shape->get) return bad("request " + std::to_string(request) + " has no reply");
  if (report.size() != hid_report_bytes || report[0] != static_cast<std::byte>(*shape->get)) {
    return bad("feature report " + std::to_string(static_cast<unsigned>(*shape->get)) + " came back with " +
               std::to_string(report.size()) + " bytes or another id, expected " + std::to_string(hid_report_bytes));
  }
  std::size_t bytes = shape->reply_bytes;
  if (static_cast<Request>(request) == Request::get_desc) {
    bytes = std::to_integer<std::size_t>(report[3]);
    if (bytes > hid_page_bytes)
      return bad("a page of the descriptor says that it has " + std::to_string(bytes) + " bytes");
    if (payload.size() == PageRequest::bytes &&
        load_little<std::uint16_t>(report.data() + 1) != load_little<std::uint16_t>(payload.data())) {
      return bad("another page of the descriptor came than the one that was asked for; ask again");
    }
  }
  bytes = std::min(bytes, reply.size());
  std::copy_n(report.begin() + static_cast<std::ptrdiff_t>(shape->reply_at), bytes, reply.begin());
  return bytes;
}

}  // namespace compueye::protocol
