#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "drivers/recording/recording_format.hpp"
#include "hal/sample_block.hpp"

namespace compueye::recording {

enum class BlockKind : std::uint8_t { frame = 1, end = 2 };

/// Why a recording has an end block; one that has none was cut off.
enum class Ending : std::uint8_t {
  stopped = 0,        ///< the reader had enough
  end_of_stream = 1,  ///< the source had no more
  source_failed = 2,  ///< the source could not go on
};
[[nodiscard]] const char* name(Ending ending) noexcept;

/// The books up to and with a block, all counted from the beginning of the recording, so that a damaged block takes
/// nothing of them away.
struct RecordedBooks {
  std::uint64_t index = 0;       ///< frame blocks before this one
  std::uint64_t unrecorded = 0;  ///< frames that were delivered and did not get into the file: its writer was too slow
  std::array<std::uint64_t, recorded_reasons> dropped{};  ///< the source's own, by hal::DropReason
  std::uint64_t estimated = 0;                            ///< of those; end block only
};

/// Head of a block: everything but the samples.
struct BlockHead {
  BlockKind kind = BlockKind::frame;
  Ending ending = Ending::stopped;  ///< end block only
  hal::BlockFlags flags;            ///< frame block only, and so are frame, t_ns and config_id
  std::uint32_t config_id = 0;
  std::uint64_t frame = 0;
  std::int64_t t_ns = 0;
  std::int64_t arrival_ns = 0;  ///< when the host had it: Clock time since the recording's start
  RecordedBooks books;
};

/// Writes a frame block: `to` has frame_block_bytes() for the samples' number and depth. False, and `to` is void, when
/// a code lies outside 0 .. 2^bits - 1 or a counter or time beyond the format's limits.
[[nodiscard]] bool encode_frame_block(const BlockHead& head, std::span<const std::int32_t> codes,
                                      std::span<const std::uint8_t> valid, int bits, std::span<std::byte> to) noexcept;
/// Writes an end block; false as above.
[[nodiscard]] bool encode_end_block(const BlockHead& head, std::span<std::byte, end_block_bytes> to) noexcept;

/// The head whose bytes these are, if its CRC, kind, flags, limits and unused bytes are right and its length is that
/// of its kind, which for a frame block is `frame_bytes`.
[[nodiscard]] std::optional<BlockHead> decode_head(std::span<const std::byte, block_head_bytes> bytes,
                                                   std::size_t frame_bytes) noexcept;

/// Whether a block may come after those up to `last` (its index: frame blocks up to and with the last one) and
/// `last_frame`: indices, counters and, of frame blocks, frame numbers never fall, so that a block which was copied or
/// moved is not taken for one.
[[nodiscard]] bool follows(const BlockHead& head, const RecordedBooks& last,
                           std::optional<std::uint64_t> last_frame) noexcept;

/// Whether the CRC over a whole block is right.
[[nodiscard]] bool sealed(std::span<const std::byte> block) noexcept;

/// The samples of a sealed frame block for `codes.size()` channels. False when a code lies beyond `bits` or a bit
/// behind the last channel's validity is set.
[[nodiscard]] bool decode_samples(std::span<const std::byte> block, int bits, std::span<std::int32_t> codes,
                                  std::span<std::uint8_t> valid) noexcept;

}  // namespace compueye::recording
