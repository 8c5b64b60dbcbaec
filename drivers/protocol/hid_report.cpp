#include "drivers/protocol/hid_report.hpp"

#include <algorithm>

#include "drivers/protocol/crc16.hpp"
#include "drivers/protocol/little_endian.hpp"
#include "drivers/protocol/sample_format.hpp"

namespace compueye::protocol {
namespace {

constexpr std::size_t crc_at = 6, payload_at = 8;
static_assert(payload_at + hid_payload_bytes == hid_report_bytes);

std::uint16_t crc_of(std::span<const std::byte> report) noexcept {
  return crc16(report.subspan(payload_at, hid_payload_bytes), crc16(report.first(crc_at)));
}

}  // namespace

void encode_hid_report(const HidReport& report, std::span<const std::int32_t> codes,
                       std::span<std::byte, hid_report_bytes> into) noexcept {
  std::fill(into.begin(), into.end(), std::byte{0});
  store_little(into.data(), hid_input_report);
  store_little(into.data() + 1, report.flags);
  store_little(into.data() + 2, report.frame);
  store_little(into.data() + 4, report.part);
  store_little(into.data() + 5, report.parts);
  const auto sent = codes.first(std::min<std::size_t>(codes.size(), hid_channels_per_report));
  pack(SampleFormat::u12, sent, hid_bits, into.subspan(payload_at, packed_bytes(SampleFormat::u12, sent.size())));
  store_little(into.data() + crc_at, crc_of(into));
}

ParsedHidReport parse_hid_report(std::span<const std::byte> bytes) noexcept {
  if (bytes.size() != hid_report_bytes) return {HidFault::wrong_length, {}};
  if (load_little<std::uint8_t>(bytes.data()) != hid_input_report) return {HidFault::wrong_id, {}};
  if (load_little<std::uint16_t>(bytes.data() + crc_at) != crc_of(bytes)) return {HidFault::wrong_crc, {}};
  const HidReport report{load_little<std::uint8_t>(bytes.data() + 1), load_little<std::uint16_t>(bytes.data() + 2),
                         load_little<std::uint8_t>(bytes.data() + 4), load_little<std::uint8_t>(bytes.data() + 5),
                         bytes.subspan(payload_at, hid_payload_bytes)};
  if (report.part >= report.parts) return {HidFault::wrong_part, {}};
  return {HidFault::none, report};
}

}  // namespace compueye::protocol
