#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/protocol/hid_report.hpp"
#include "hal/result.hpp"

namespace compueye::protocol {

/// Requests travel over HID as feature reports of 64 bytes, id first, unused bytes 0:
///
///   report            SET                                       GET
///   2 descriptor      PageRequest (4)                           page u16, count u8, bytes (60)
///   3 configuration   request u8, Configuration for SET_CONFIG  request u8 (the last), Configuration in force (16)
///   4 illumination    Illumination (8)                          the last Illumination (8)
///   5 counters, time  nonce u32                                 PingReply (8), Status (48)
///
/// GET_DESC is a SET and a GET of 2; SET_CONFIG, START, STOP and RESET_PIPES a SET of 3; GET_CONFIG a GET of 3;
/// SET_ILLUM a SET of 4; PING a SET and a GET of 5; STATUS a GET of 5. A device refuses by stalling the report.
enum class HidFeature : std::uint8_t { descriptor = 2, configuration = 3, illumination = 4, counters = 5 };

/// Of a descriptor's page, beside its number and count.
inline constexpr std::size_t hid_page_bytes = 60;

using HidReportBytes = std::array<std::byte, hid_report_bytes>;

/// The feature reports that carry one request: first the SET, if any, then the GET, if any.
struct HidExchange {
  bool has_set = false;
  HidReportBytes set{};
  bool has_get = false;
  HidFeature get = HidFeature::descriptor;
};

/// For the host. Errors: unsupported (a request that HID does not carry), usage (a payload or reply of another length
/// than the request's).
[[nodiscard]] hal::Result<HidExchange> hid_exchange(std::uint8_t request, std::span<const std::byte> payload,
                                                    std::size_t reply_bytes);

/// The reply of `request` out of the GET report that answered hid_exchange(request, payload, ...): bytes written to
/// `reply`. Errors: bad_format (another length or id, another page than was asked for, more bytes than a page).
[[nodiscard]] hal::Result<std::size_t> hid_reply(std::uint8_t request, std::span<const std::byte> payload,
                                                 std::span<const std::byte> report, std::span<std::byte> reply);

}  // namespace compueye::protocol
