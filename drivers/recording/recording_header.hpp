#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hal/result.hpp"
#include "hal/sample_source.hpp"

namespace compueye::recording {

/// What a recording says before its first block.
struct RecordingHeader {
  hal::SourceDescription source;   ///< as the recorded source described itself; texts of at most 255 bytes
  std::int64_t began_unix_ns = 0;  ///< wall clock when the file was begun, ns since 1970 UTC; for people
  std::string settings;            ///< lines "key = value" on what was recorded, at most 65,535 bytes; for people
};

/// Error out_of_range names the field that a recording cannot hold.
[[nodiscard]] hal::Result<void> check_header(const RecordingHeader& header);

/// The header's bytes. Errors: those of check_header().
[[nodiscard]] hal::Result<std::vector<std::byte>> serialise(const RecordingHeader& header);

/// Length of the whole header as its first fixed_header_bytes state it, bounded by what the limits of the format allow.
/// Errors: bad_format (no recording, or not `fixed_header_bytes` bytes), unsupported (a later version).
[[nodiscard]] hal::Result<std::size_t> stated_header_bytes(std::span<const std::byte> begin, std::string_view place);

/// `bytes`: exactly the header. Error bad_format names the field and the byte it stands at. Allocates no more than a
/// small multiple of the bytes that are there.
[[nodiscard]] hal::Result<RecordingHeader> parse_header(std::span<const std::byte> bytes, std::string_view place);

}  // namespace compueye::recording
