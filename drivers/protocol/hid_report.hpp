#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace compueye::protocol {

inline constexpr std::size_t hid_report_bytes = 64;  ///< every report, its id included
inline constexpr std::uint8_t hid_input_report = 1;
inline constexpr std::size_t hid_payload_bytes = 56;
inline constexpr int hid_channels_per_report = 37;
inline constexpr int hid_bits = 12;  ///< codes are always packed as u12; a HID eye has at most 12 bits
inline constexpr int hid_most_channels = 255 * hid_channels_per_report;

/// Bits of HidReport::flags.
namespace hid_flag {
inline constexpr std::uint8_t overrun = 1U << 0U;  ///< frames were dropped in the device just before this one
inline constexpr std::uint8_t sat = 1U << 1U;      ///< a channel of this report is at full scale
inline constexpr std::uint8_t dark = 1U << 2U;     ///< exposed with every illuminator off and settled
inline constexpr std::uint8_t time_ok = 1U << 3U;  ///< the device clock runs and has not been set since the last frame
inline constexpr unsigned config_tag_shift = 4;    ///< the four high bits: config_id modulo 16
}  // namespace hid_flag

/// What a device answers to "get report descriptor" (USB HID 1.11, 6.2.2): how hosts know its reports.
inline constexpr std::array<std::uint8_t, 47> hid_report_descriptor{
    0x06, 0x00, 0xFF,                    // usage page: of the vendor
    0x09, 0x01,                          // usage 1
    0xA1, 0x01,                          // collection: application
    0x15, 0x00,                          // logical minimum 0
    0x26, 0xFF, 0x00,                    // logical maximum 255
    0x75, 0x08,                          // report size: 8 bits
    0x95, 0x3F,                          // report count: 63
    0x85, 0x01, 0x09, 0x01, 0x81, 0x02,  // report 1: input
    0x85, 0x02, 0x09, 0x02, 0xB1, 0x02,  // reports 2 to 5: feature
    0x85, 0x03, 0x09, 0x03, 0xB1, 0x02,  //
    0x85, 0x04, 0x09, 0x04, 0xB1, 0x02,  //
    0x85, 0x05, 0x09, 0x05, 0xB1, 0x02,  //
    0xC0,                                // end of collection
};

/// One input report of 64 bytes: id, flags, frame u16, part, parts, CRC-16, 56 B payload = 37 codes of 12 bits. The CRC
/// covers the bytes before it and the payload. Part p carries channels 37 p .. 37 p + 36; unused codes are 0.
struct HidReport {
  std::uint8_t flags = 0;              ///< hid_flag
  std::uint16_t frame = 0;             ///< counts exposures since START, from 0, modulo 2^16
  std::uint8_t part = 0;               ///< 0 .. parts - 1
  std::uint8_t parts = 1;              ///< of every frame: channels / 37, rounded up
  std::span<const std::byte> payload;  ///< 56 bytes, in the report

  [[nodiscard]] bool has(std::uint8_t flag) const noexcept { return (flags & flag) != 0; }
  [[nodiscard]] std::uint8_t config_tag() const noexcept {
    return static_cast<std::uint8_t>(flags >> hid_flag::config_tag_shift);
  }
};

/// Parts that `channels` channels (1 .. hid_most_channels) need.
[[nodiscard]] constexpr int hid_parts(int channels) noexcept {
  return (channels + hid_channels_per_report - 1) / hid_channels_per_report;
}

/// Writes a report of the codes (0 .. 4095, at most 37) of one part; report.payload is not used.
void encode_hid_report(const HidReport& report, std::span<const std::int32_t> codes,
                       std::span<std::byte, hid_report_bytes> into) noexcept;

enum class HidFault : std::uint8_t { none, wrong_length, wrong_id, wrong_crc, wrong_part };

/// Checks a report: length, id, CRC, part < parts.
struct ParsedHidReport {
  HidFault fault = HidFault::none;
  HidReport report;  ///< when fault is none
};
[[nodiscard]] ParsedHidReport parse_hid_report(std::span<const std::byte> bytes) noexcept;

}  // namespace compueye::protocol
