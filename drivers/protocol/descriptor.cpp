#include "drivers/protocol/descriptor.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "drivers/protocol/crc32c.hpp"
#include "drivers/protocol/little_endian.hpp"
#include "hal/try.hpp"

namespace compueye::protocol {
namespace {

constexpr std::uint32_t descriptor_magic = 0x44594543U;  // "CEYD"
constexpr std::size_t fixed_bytes = 48;
constexpr std::size_t channel_bytes = 6;
constexpr std::size_t illuminator_bytes = 12;
constexpr std::size_t crc_bytes = 4;
constexpr std::array all_formats{SampleFormat::u16, SampleFormat::u12, SampleFormat::i24};

using Fault = tl::unexpected<hal::Error>;

Fault bad(std::string_view place, std::string sentence) {
  return hal::fail(hal::ErrorCode::bad_format, std::string(place), "the descriptor " + std::move(sentence));
}

std::uint16_t format_bit(SampleFormat format) {
  return static_cast<std::uint16_t>(1U << static_cast<unsigned>(format));
}

bool printable(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~'; });
}

hal::Result<void> check_texts(const DeviceDescriptor& d) {
  for (const auto& [what, text] : {std::pair{"serial", &d.serial}, {"firmware", &d.firmware}}) {
    if (text->empty() || text->size() > DeviceDescriptor::most_text || !printable(*text)) {
      return hal::fail(hal::ErrorCode::out_of_range, printable(d.serial) ? d.serial : std::string(),
                       std::string("the descriptor's ") + what + " is not 1 to " +
                           std::to_string(DeviceDescriptor::most_text) + " printable ASCII characters");
    }
  }
  return {};
}

hal::Result<void> check_channels(const DeviceDescriptor& d) {
  const auto channels = static_cast<std::size_t>(d.channels);
  const auto refuse = [&](const char* sentence) { return hal::fail(hal::ErrorCode::out_of_range, d.serial, sentence); };
  if (d.ommatidium_of_channel.size() != channels || d.sample_offset_ns.size() != channels) {
    return refuse("the descriptor's channel map does not have one entry a channel");
  }
  std::vector<bool> seen(channels);
  for (const std::int32_t ommatidium : d.ommatidium_of_channel) {
    if (ommatidium < 0 || ommatidium >= d.channels || seen[static_cast<std::size_t>(ommatidium)]) {
      return refuse("the descriptor's channel map is not a permutation of 0 .. M-1");
    }
    seen[static_cast<std::size_t>(ommatidium)] = true;
  }
  if (std::any_of(d.sample_offset_ns.begin(), d.sample_offset_ns.end(), [](auto offset) { return offset < 0; })) {
    return refuse("a sample offset of the descriptor is negative or above 2147483647 ns");
  }
  return {};
}

void append_text(std::vector<std::byte>& bytes, std::string_view text) {
  for (const char c : text) bytes.push_back(static_cast<std::byte>(c));
}

std::string text_of(std::span<const std::byte> bytes) {
  std::string text;
  for (const std::byte b : bytes) text.push_back(static_cast<char>(b));
  return text;
}

IlluminatorEntry load_illuminator(const std::byte* at) {
  return {load_little<std::uint8_t>(at),      static_cast<IlluminatorKind>(load_little<std::uint8_t>(at + 1)),
          load_little<std::uint16_t>(at + 2), load_little<std::uint16_t>(at + 4),
          load_little<std::uint16_t>(at + 6), load_little<std::uint32_t>(at + 8)};
}

/// Takes `count` bytes off the front of a span that is known to be long enough.
std::span<const std::byte> front(std::span<const std::byte>& rest, std::size_t count) {
  const auto taken = rest.first(count);
  rest = rest.subspan(count);
  return taken;
}

void load_fixed(const std::byte* at, DeviceDescriptor& d) {
  d.bits = load_little<std::uint8_t>(at + 9);
  const auto mask = load_little<std::uint16_t>(at + 14);
  for (const SampleFormat format : all_formats) {
    if ((mask & format_bit(format)) != 0) d.formats.push_back(format);
  }
  d.least_frame_rate_mhz = load_little<std::uint32_t>(at + 20);
  d.most_frame_rate_mhz = load_little<std::uint32_t>(at + 24);
  d.least_exposure_ns = load_little<std::uint32_t>(at + 28);
  d.most_exposure_ns = load_little<std::uint32_t>(at + 32);
  d.most_payload = load_little<std::uint16_t>(at + 36);
}

/// What follows the fixed part, whose lengths have been checked.
void load_tables(std::span<const std::byte> rest, const std::byte* fixed, DeviceDescriptor& d) {
  d.serial = text_of(front(rest, load_little<std::uint8_t>(fixed + 38)));
  d.firmware = text_of(front(rest, load_little<std::uint8_t>(fixed + 39)));
  const auto channels = static_cast<std::size_t>(d.channels);
  d.ommatidium_of_channel.reserve(channels);
  d.sample_offset_ns.reserve(channels);
  for (std::size_t k = 0; k < channels; ++k) {
    const std::byte* const at = front(rest, channel_bytes).data();
    d.ommatidium_of_channel.push_back(load_little<std::uint16_t>(at));
    d.sample_offset_ns.push_back(load_little<std::int32_t>(at + 2));
  }
  for (std::size_t k = 0; k < load_little<std::uint8_t>(fixed + 40); ++k) {
    d.illuminators.push_back(load_illuminator(front(rest, illuminator_bytes).data()));
  }
}

}  // namespace

bool DeviceDescriptor::offers(SampleFormat format) const noexcept {
  return most_bits(format) >= bits && std::find(formats.begin(), formats.end(), format) != formats.end();
}

hal::SourceDescription DeviceDescriptor::source_description(std::string_view backend, double frame_rate_hz) const {
  hal::SourceDescription description;
  description.backend = backend;
  description.serial = serial;
  description.firmware = firmware;
  description.channels = channels;
  description.bits = bits;
  description.frame_rate_hz = frame_rate_hz;
  description.ommatidium_of_channel = ommatidium_of_channel;
  return description;
}

hal::Result<void> check_descriptor(const DeviceDescriptor& d) {
  TRY(check_texts(d));
  const auto refuse = [&](std::string sentence) {
    return hal::fail(hal::ErrorCode::out_of_range, d.serial, "the descriptor " + std::move(sentence));
  };
  if (d.channels < 1 || d.channels > most_channels) {
    return refuse("names " + std::to_string(d.channels) + " channels, expected 1 to " + std::to_string(most_channels));
  }
  if (d.bits < 1 || d.bits > 24) return refuse("names " + std::to_string(d.bits) + " bits, expected 1 to 24");
  if (std::none_of(d.formats.begin(), d.formats.end(), [&](auto format) { return d.offers(format); })) {
    return refuse("names no sample format that holds " + std::to_string(d.bits) + " bits");
  }
  if (d.most_payload < 3)
    return refuse("allows payloads of " + std::to_string(d.most_payload) + " bytes, expected 3 or more");
  if (d.least_frame_rate_mhz < 1 || d.most_frame_rate_mhz < d.least_frame_rate_mhz) {
    return refuse("has no frame rate between its limits of " + std::to_string(d.least_frame_rate_mhz) + " and " +
                  std::to_string(d.most_frame_rate_mhz) + " mHz");
  }
  if (d.most_exposure_ns < d.least_exposure_ns) return refuse("has a longest exposure below its shortest");
  if (d.illuminators.size() > DeviceDescriptor::most_illuminators) return refuse("names more than 255 illuminators");
  for (const IlluminatorEntry& light : d.illuminators) {
    if (light.levels < 2 || light.rows < 1 || light.cols < 1) {
      return refuse("has an illuminator " + std::to_string(light.id) + " without levels or pixels");
    }
  }
  return check_channels(d);
}

hal::Result<std::vector<std::byte>> serialise(const DeviceDescriptor& d) {
  TRY(check_descriptor(d));
  std::vector<std::byte> bytes(fixed_bytes);
  append_text(bytes, d.serial);
  append_text(bytes, d.firmware);
  for (std::size_t k = 0; k < d.ommatidium_of_channel.size(); ++k) {
    std::byte entry[channel_bytes];
    store_little(entry, static_cast<std::uint16_t>(d.ommatidium_of_channel[k]));
    store_little(entry + 2, d.sample_offset_ns[k]);
    bytes.insert(bytes.end(), std::begin(entry), std::end(entry));
  }
  for (const IlluminatorEntry& light : d.illuminators) {
    std::byte entry[illuminator_bytes];
    store_little(entry, light.id);
    store_little(entry + 1, static_cast<std::uint8_t>(light.kind));
    store_little(entry + 2, light.levels);
    store_little(entry + 4, light.rows);
    store_little(entry + 6, light.cols);
    store_little(entry + 8, light.settle_ns);
    bytes.insert(bytes.end(), std::begin(entry), std::end(entry));
  }
  std::byte* const at = bytes.data();
  store_little(at, descriptor_magic);
  store_little(at + 4, static_cast<std::uint32_t>(bytes.size() + crc_bytes));
  store_little(at + 8, d.version.byte());
  store_little(at + 9, static_cast<std::uint8_t>(d.bits));
  store_little(at + 12, static_cast<std::uint16_t>(fixed_bytes));
  std::uint16_t mask = 0;
  for (const SampleFormat format : d.formats) mask = static_cast<std::uint16_t>(mask | format_bit(format));
  store_little(at + 14, mask);
  store_little(at + 16, static_cast<std::uint32_t>(d.channels));
  store_little(at + 20, d.least_frame_rate_mhz);
  store_little(at + 24, d.most_frame_rate_mhz);
  store_little(at + 28, d.least_exposure_ns);
  store_little(at + 32, d.most_exposure_ns);
  store_little(at + 36, d.most_payload);
  store_little(at + 38, static_cast<std::uint8_t>(d.serial.size()));
  store_little(at + 39, static_cast<std::uint8_t>(d.firmware.size()));
  store_little(at + 40, static_cast<std::uint8_t>(d.illuminators.size()));
  std::byte crc[crc_bytes];
  store_little(crc, crc32c(bytes));
  bytes.insert(bytes.end(), std::begin(crc), std::end(crc));
  return bytes;
}

hal::Result<DescriptorPrefix> load_descriptor_prefix(std::span<const std::byte> first_bytes, std::string_view place) {
  if (first_bytes.size() < DescriptorPrefix::bytes) {
    return bad(place, "has " + std::to_string(first_bytes.size()) + " bytes, expected at least " +
                          std::to_string(DescriptorPrefix::bytes));
  }
  if (load_little<std::uint32_t>(first_bytes.data()) != descriptor_magic) {
    return bad(place, "does not begin with CEYD: this is not a compound eye");
  }
  const std::size_t length = load_little<std::uint32_t>(first_bytes.data() + 4);
  if (length < DescriptorPrefix::least_length || length > DeviceDescriptor::most_bytes) {
    return bad(place, "says that it is " + std::to_string(length) + " bytes long, expected " +
                          std::to_string(DescriptorPrefix::least_length) + " to " +
                          std::to_string(DeviceDescriptor::most_bytes));
  }
  return DescriptorPrefix{length, ProtocolVersion::from_byte(load_little<std::uint8_t>(first_bytes.data() + 8))};
}

hal::Result<DeviceDescriptor> parse_descriptor(std::span<const std::byte> bytes, std::string_view place) {
  const auto prefix = TRY(load_descriptor_prefix(bytes, place));
  TRY(check_version(prefix.version, place));
  if (prefix.length != bytes.size() || bytes.size() < DeviceDescriptor::least_bytes) {
    return bad(place, "says that it is " + std::to_string(prefix.length) + " bytes long and has " +
                          std::to_string(bytes.size()));
  }
  const std::byte* const fixed = bytes.data();
  const std::size_t covered = bytes.size() - crc_bytes;
  if (crc32c(bytes.first(covered)) != load_little<std::uint32_t>(fixed + covered)) {
    return bad(place, "came damaged (CRC); fetch it again");
  }
  DeviceDescriptor d;
  d.version = prefix.version;
  const std::uint32_t channels = load_little<std::uint32_t>(fixed + 16);
  if (channels < 1 || channels > static_cast<std::uint32_t>(most_channels)) {
    return bad(place,
               "names " + std::to_string(channels) + " channels, expected 1 to " + std::to_string(most_channels));
  }
  d.channels = static_cast<int>(channels);
  const std::size_t header = load_little<std::uint16_t>(fixed + 12);
  const std::size_t tables = std::size_t{load_little<std::uint8_t>(fixed + 38)} +
                             load_little<std::uint8_t>(fixed + 39) + channels * channel_bytes +
                             load_little<std::uint8_t>(fixed + 40) * illuminator_bytes;
  if (header < fixed_bytes || header + tables > covered) {
    return bad(place, "is too short for the tables that it announces");
  }
  load_fixed(fixed, d);
  load_tables(bytes.subspan(header, tables), fixed, d);
  TRY(check_descriptor(d));
  return d;
}

}  // namespace compueye::protocol
