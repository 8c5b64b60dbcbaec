#include "drivers/recording/recording_header.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#include "drivers/protocol/crc32c.hpp"
#include "drivers/protocol/little_endian.hpp"
#include "drivers/recording/recording_format.hpp"
#include "hal/try.hpp"

namespace compueye::recording {
namespace {

using hal::ErrorCode;
using protocol::load_little;
using protocol::store_little;

struct TextLengths {
  std::size_t backend, serial, firmware, settings;
  [[nodiscard]] std::size_t sum() const noexcept { return backend + serial + firmware + settings; }
};

std::size_t header_bytes(std::size_t channels, const TextLengths& texts) {
  return fixed_header_bytes + texts.sum() + 8 * channels + crc_bytes;
}

/// Empty when the map gives every channel an ommatidium of its own.
std::string map_complaint(const std::vector<std::int32_t>& map) {
  std::vector<std::uint8_t> taken(map.size(), 0);
  for (std::size_t c = 0; c < map.size(); ++c) {
    if (map[c] < 0 || static_cast<std::size_t>(map[c]) >= map.size()) {
      return "channel " + std::to_string(c) + " is mapped to ommatidium " + std::to_string(map[c]) +
             ", expected 0 to " + std::to_string(map.size() - 1);
    }
    if (std::exchange(taken[static_cast<std::size_t>(map[c])], std::uint8_t{1}) != 0) {
      return "channel " + std::to_string(c) + " is mapped to ommatidium " + std::to_string(map[c]) +
             ", which another channel has";
    }
  }
  return {};
}

std::string complaint(const RecordingHeader& header) {
  const hal::SourceDescription& s = header.source;
  if (s.channels < 1 || s.channels > most_channels) {
    return "has " + std::to_string(s.channels) + " channels, expected 1 to " + std::to_string(most_channels);
  }
  if (s.bits < 1 || s.bits > most_bits) return "has " + std::to_string(s.bits) + " bits, expected 1 to 24";
  if (!std::isfinite(s.frame_rate_hz) || s.frame_rate_hz < 0.0) return "has a frame rate that is no rate";
  if (s.backend.empty() || s.serial.empty()) return "has no name or no serial number";
  const std::pair<const char*, const std::string*> texts[] = {
      {"backend", &s.backend}, {"serial", &s.serial}, {"firmware", &s.firmware}};
  for (const auto& [name, text] : texts) {
    if (text->size() > most_text_bytes) {
      return std::string(name) + " has " + std::to_string(text->size()) + " bytes, expected at most 255";
    }
  }
  if (header.settings.size() > most_settings_bytes) {
    return "settings have " + std::to_string(header.settings.size()) + " bytes, expected at most 65535";
  }
  const auto channels = static_cast<std::size_t>(s.channels);
  if (s.ommatidium_of_channel.size() != channels) return "does not have one entry a channel in its channel map";
  return map_complaint(s.ommatidium_of_channel);
}

TextLengths text_lengths(std::span<const std::byte> fixed) {
  return {std::to_integer<std::size_t>(fixed[40]), std::to_integer<std::size_t>(fixed[41]),
          std::to_integer<std::size_t>(fixed[42]), load_little<std::uint16_t>(fixed.data() + 44)};
}

}  // namespace

hal::Result<void> check_header(const RecordingHeader& header) {
  std::string what = complaint(header);
  if (what.empty()) return {};
  return hal::fail(ErrorCode::out_of_range, header.source.serial, what + "; a recording cannot hold this source");
}

hal::Result<std::vector<std::byte>> serialise(const RecordingHeader& header) {
  TRY(check_header(header));
  const hal::SourceDescription& s = header.source;
  const TextLengths texts{s.backend.size(), s.serial.size(), s.firmware.size(), header.settings.size()};
  std::vector<std::byte> bytes(header_bytes(static_cast<std::size_t>(s.channels), texts));
  std::byte* const at = bytes.data();
  std::memcpy(at, file_magic.data(), file_magic.size());
  store_little(at + 8, format_version);
  store_little(at + 10, static_cast<std::uint16_t>(s.bits));
  store_little(at + 12, static_cast<std::uint32_t>(bytes.size()));
  store_little(at + 16, static_cast<std::uint32_t>(s.channels));
  store_little(at + 24, std::bit_cast<std::uint64_t>(s.frame_rate_hz));
  store_little(at + 32, header.began_unix_ns);
  at[40] = static_cast<std::byte>(texts.backend);
  at[41] = static_cast<std::byte>(texts.serial);
  at[42] = static_cast<std::byte>(texts.firmware);
  store_little(at + 44, static_cast<std::uint16_t>(texts.settings));
  std::byte* to = at + fixed_header_bytes;
  for (const std::string* text : {&s.backend, &s.serial, &s.firmware, &header.settings}) {
    std::memcpy(to, text->data(), text->size());
    to += text->size();
  }
  for (const std::int32_t ommatidium : s.ommatidium_of_channel) {
    store_little(to, ommatidium);
    to += 4;
  }
  to += 4 * s.ommatidium_of_channel.size();  // the sample offsets, all 0
  store_little(to, protocol::crc32c(std::span(bytes).first(bytes.size() - crc_bytes)));
  return bytes;
}

hal::Result<std::size_t> stated_header_bytes(std::span<const std::byte> begin, std::string_view place) {
  if (begin.size() < fixed_header_bytes) {
    return hal::fail(ErrorCode::bad_format, std::string(place),
                     "ends within its header: it has " + std::to_string(begin.size()) +
                         " bytes, and a recording begins with at least " + std::to_string(fixed_header_bytes));
  }
  if (std::memcmp(begin.data(), file_magic.data(), file_magic.size()) != 0) {
    return hal::fail(ErrorCode::bad_format, std::string(place),
                     "is not a recording: it does not begin with CEYEREC and a line end (byte 0)");
  }
  const auto version = load_little<std::uint16_t>(begin.data() + 8);
  if (version != format_version) {
    return hal::fail(ErrorCode::unsupported, std::string(place),
                     "is a recording of version " + std::to_string(version) + " (byte 8), this program reads version " +
                         std::to_string(format_version));
  }
  const std::size_t stated = load_little<std::uint32_t>(begin.data() + 12);
  const std::size_t channels = load_little<std::uint32_t>(begin.data() + 16);
  if (channels < 1 || channels > static_cast<std::size_t>(most_channels)) {
    return hal::fail(
        ErrorCode::bad_format, std::string(place),
        "states " + std::to_string(channels) + " channels (byte 16), expected 1 to " + std::to_string(most_channels));
  }
  if (const std::size_t expected = header_bytes(channels, text_lengths(begin)); stated != expected) {
    return hal::fail(ErrorCode::bad_format, std::string(place),
                     "states a header of " + std::to_string(stated) + " bytes (byte 12), expected " +
                         std::to_string(expected) + " for its channels and texts");
  }
  return stated;
}

hal::Result<RecordingHeader> parse_header(std::span<const std::byte> bytes, std::string_view place) {
  const auto stated = TRY(stated_header_bytes(bytes, place));
  if (stated != bytes.size()) {
    return hal::fail(
        ErrorCode::bad_format, std::string(place),
        "ends within its header: it has " + std::to_string(bytes.size()) + " of " + std::to_string(stated) + " bytes");
  }
  const std::size_t covered = bytes.size() - crc_bytes;
  if (protocol::crc32c(bytes.first(covered)) != load_little<std::uint32_t>(bytes.data() + covered)) {
    return hal::fail(ErrorCode::bad_format, std::string(place),
                     "has a damaged header: the CRC at byte " + std::to_string(covered) +
                         " does not match; without the header its blocks cannot be read");
  }
  RecordingHeader header;
  hal::SourceDescription& s = header.source;
  s.bits = load_little<std::uint16_t>(bytes.data() + 10);
  s.channels = static_cast<int>(load_little<std::uint32_t>(bytes.data() + 16));
  s.frame_rate_hz = std::bit_cast<double>(load_little<std::uint64_t>(bytes.data() + 24));
  header.began_unix_ns = load_little<std::int64_t>(bytes.data() + 32);
  const TextLengths texts = text_lengths(bytes);
  const std::byte* from = bytes.data() + fixed_header_bytes;
  const auto take = [&from](std::string& text, std::size_t length) {
    text.assign(reinterpret_cast<const char*>(from), length);
    from += length;
  };
  take(s.backend, texts.backend);
  take(s.serial, texts.serial);
  take(s.firmware, texts.firmware);
  take(header.settings, texts.settings);
  s.ommatidium_of_channel.resize(static_cast<std::size_t>(s.channels));
  for (std::int32_t& ommatidium : s.ommatidium_of_channel) {
    ommatidium = load_little<std::int32_t>(from);
    from += 4;
  }
  const std::string what = complaint(header);
  const std::byte unused[] = {bytes[20], bytes[21], bytes[22], bytes[23], bytes[43], bytes[46], bytes[47]};
  if (!what.empty()) return hal::fail(ErrorCode::bad_format, std::string(place), "has a wrong header: " + what);
  if (std::any_of(std::begin(unused), std::end(unused), [](std::byte b) { return b != std::byte{0}; })) {
    return hal::fail(ErrorCode::bad_format, std::string(place),
                     "has a wrong header: the bytes 20 to 23, 43, 46 and 47 must be 0");
  }
  return header;
}

}  // namespace compueye::recording
