#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/protocol/frame_header.hpp"
#include "drivers/protocol/sample_format.hpp"
#include "drivers/protocol/version.hpp"
#include "hal/result.hpp"
#include "hal/sample_source.hpp"

namespace compueye::protocol {

enum class IlluminatorKind : std::uint8_t { lamp = 1, display = 2 };  ///< others: of a newer minor version

struct IlluminatorEntry {
  std::uint8_t id = 0;  ///< as SET_ILLUM names it
  IlluminatorKind kind = IlluminatorKind::lamp;
  std::uint16_t levels = 2;          ///< distinguishable intensities with off, >= 2
  std::uint16_t rows = 1, cols = 1;  ///< >= 1
  std::uint32_t settle_ns = 0;       ///< from SET_ILLUM to stable light
  friend bool operator==(const IlluminatorEntry&, const IlluminatorEntry&) noexcept = default;
};

/// What a device says about itself: GET_DESC's answer (docs/protocol.md, "Descriptor").
struct DeviceDescriptor {
  static constexpr std::size_t most_bytes = 1U << 20U;  ///< of the serialised form
  static constexpr std::size_t least_bytes = 60;        ///< one channel, texts of one character
  static constexpr std::size_t most_text = 64;          ///< characters of serial and firmware, at least 1 each
  static constexpr std::size_t most_illuminators = 255;
  static constexpr std::uint32_t most_offset_ns = 0x7FFFFFFF;

  ProtocolVersion version = host_version;
  std::string serial;                  ///< printable ASCII
  std::string firmware;                ///< printable ASCII
  int channels = 0;                    ///< M: 1 .. 65535
  int bits = 0;                        ///< 1 .. 24
  std::vector<SampleFormat> formats;   ///< at least one that is deep enough for `bits`
  std::uint16_t most_payload = 65535;  ///< longest payload of a packet it sends, in bytes
  std::uint32_t least_frame_rate_mhz = 1000, most_frame_rate_mhz = 1000;  ///< frames a second times 1000
  std::uint32_t least_exposure_ns = 0, most_exposure_ns = 0;
  std::vector<std::int32_t> ommatidium_of_channel;  ///< M entries: a permutation of 0 .. M-1
  std::vector<std::int32_t> sample_offset_ns;  ///< M entries >= 0: when after t_ns. For people; nothing corrects for it
  std::vector<IlluminatorEntry> illuminators;  ///< at most 255

  [[nodiscard]] bool offers(SampleFormat format) const noexcept;
  [[nodiscard]] PacketLimits packet_limits() const noexcept { return {channels, most_payload}; }
  /// For a SampleSource of `backend` at `frame_rate_hz`.
  [[nodiscard]] hal::SourceDescription source_description(std::string_view backend, double frame_rate_hz) const;
  friend bool operator==(const DeviceDescriptor&, const DeviceDescriptor&) = default;
};

/// Error out_of_range names the first field that breaks the limits above.
[[nodiscard]] hal::Result<void> check_descriptor(const DeviceDescriptor& descriptor);

/// The bytes of a descriptor, CRC included. Errors: those of check_descriptor().
[[nodiscard]] hal::Result<std::vector<std::byte>> serialise(const DeviceDescriptor& descriptor);

/// What the first 12 bytes of a descriptor say, in every version of the protocol.
struct DescriptorPrefix {
  static constexpr std::size_t bytes = 12;
  static constexpr std::size_t least_length = 16;
  std::size_t length = 0;  ///< of the whole descriptor: least_length .. DeviceDescriptor::most_bytes
  ProtocolVersion version;
};

/// To know how much to fetch before anything is allocated. Errors: bad_format (too short, no descriptor, a length
/// beyond the limits). Does not judge the version.
[[nodiscard]] hal::Result<DescriptorPrefix> load_descriptor_prefix(std::span<const std::byte> first_bytes,
                                                                   std::string_view place);

/// Reads a whole descriptor. Every length is checked before use, nothing is allocated beyond the limits above. What a
/// newer minor version added is passed over. Errors: bad_format (length, CRC, contradiction), unsupported (another
/// major version), out_of_range (a value beyond its limit). `place`: the bus address.
[[nodiscard]] hal::Result<DeviceDescriptor> parse_descriptor(std::span<const std::byte> bytes, std::string_view place);

}  // namespace compueye::protocol
