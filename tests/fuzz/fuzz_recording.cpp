// Recordings: the reader and the source made of it.

#include <algorithm>
#include <cstring>
#include <vector>

#include "drivers/protocol/crc32c.hpp"
#include "drivers/protocol/little_endian.hpp"
#include "drivers/recording/recording_reader.hpp"
#include "drivers/recording/replay_source.hpp"
#include "hal/clock.hpp"
#include "tests/fuzz/fuzz_input.hpp"
#include "tests/fuzz/invariant.hpp"

using namespace compueye;
using namespace compueye::fuzz;
using namespace compueye::recording;

namespace {

void seal(std::span<std::byte> bytes) {
  const std::size_t covered = bytes.size() - crc_bytes;
  protocol::store_little(bytes.data() + covered, protocol::crc32c(bytes.first(covered)));
}

/// The bytes with the CRCs that a fuzzer does not guess: of the header, and of each block that stands where a writer
/// would have put it.
void seal_recording(std::span<std::byte> bytes) {
  const auto header = stated_header_bytes(bytes.first(std::min(bytes.size(), fixed_header_bytes)), "fuzz");
  if (!header || *header > bytes.size()) return;
  seal(bytes.first(*header));
  const std::size_t channels = protocol::load_little<std::uint32_t>(bytes.data() + 16);
  const int bits = protocol::load_little<std::uint16_t>(bytes.data() + 10);
  bytes = bytes.subspan(*header);
  while (bytes.size() >= end_block_bytes) {
    const bool frame = bytes[4] == static_cast<std::byte>(BlockKind::frame);
    const std::size_t length = frame ? frame_block_bytes(channels, bits) : end_block_bytes;
    std::memcpy(bytes.data(), block_magic.data(), block_magic.size());
    protocol::store_little(bytes.data() + 8, static_cast<std::uint32_t>(length));
    seal(bytes.first(block_head_bytes));
    if (length > bytes.size()) return;
    seal(bytes.first(length));
    bytes = bytes.subspan(length);
  }
}

void check_frame(const RecordedFrame& frame, const RecordingReader& reader) {
  const hal::SourceDescription& d = reader.header().source;
  const hal::SampleBlock& block = frame.block;
  const auto channels = static_cast<std::size_t>(d.channels);
  invariant(block.codes.size() == channels && block.valid.size() == channels, "a block has M samples");
  invariant(block.bits == d.bits, "a block has the header's depth");
  const auto within = [&](std::int32_t code) { return code >= 0 && code < (std::int32_t{1} << d.bits); };
  invariant(std::all_of(block.codes.begin(), block.codes.end(), within), "a code is within its depth");
  invariant(std::all_of(block.valid.begin(), block.valid.end(), [](auto v) { return v <= 1; }), "validity is 0 or 1");
  invariant(frame.arrival_ns >= 0, "nothing arrives before the start");
  const hal::FrameAccount account = reader.account();
  invariant(account.balanced(), "the account balances");
  invariant(account.produced > block.frame, "every frame number up to this one has a fate");
}

/// Reads all of it; every byte of the file must have been something.
std::uint64_t read_through(RecordingReader& reader) {
  std::uint64_t last = 0, frames = 0;
  const std::uint64_t header = reader.position();
  for (;;) {
    const auto frame = reader.next();
    if (!frame) {
      invariant(frame.error().code == hal::ErrorCode::end_of_stream, "memory does not fail");
      break;
    }
    invariant(frames == 0 || frame->block.frame > last, "frame numbers grow");
    last = frame->block.frame;
    ++frames;
    check_frame(*frame, reader);
  }
  const hal::SourceDescription& d = reader.header().source;
  const RecordingDamage& damage = reader.damage();
  const std::uint64_t blocks =
      frames * frame_block_bytes(static_cast<std::size_t>(d.channels), d.bits) + (reader.end() ? end_block_bytes : 0);
  invariant(header + blocks + damage.bytes + damage.torn_bytes == reader.file_bytes(), "every byte is accounted for");
  invariant(reader.account().balanced() && reader.account().delivered == frames, "the account balances at the end");
  return frames;
}

void replay(std::vector<std::byte> bytes, ReplayPace pace, std::uint64_t frames) {
  hal::VirtualClock clock;
  ReplaySource source(RecordingReader::over(stored_memory(std::move(bytes), "fuzz")).value(), pace, clock);
  invariant(source.start().has_value(), "a readable recording starts");
  std::uint64_t got = 0;
  for (int k = 0; k < 100; ++k) {
    const auto block = source.read(clock.now_ns() + 1'000'000'000);
    got += block ? 1U : 0U;
    invariant(block || block.error().place.empty(), "neither the end nor a timeout carries text");
    invariant(source.account().balanced() && source.account().delivered == got, "the replay's account balances");
    if (!block && block.error().code == hal::ErrorCode::end_of_stream) {
      invariant(got == frames, "a replay has the frames of the recording");
      break;
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input(data, size);
  const std::uint8_t how = input.byte();
  const auto raw = input.take(input.size());
  std::vector<std::byte> bytes(raw.begin(), raw.end());
  if (how % 2 == 1) seal_recording(bytes);
  auto reader = RecordingReader::over(stored_memory(bytes, "fuzz"));
  if (!reader) {
    invariant(reader.error().place == "fuzz" && !reader.error().sentence.empty(), "a refusal says why");
    return 0;
  }
  invariant(check_header(reader->header()).has_value(), "a header that was read can be written");
  const std::uint64_t frames = read_through(*reader);
  const auto account = reader->account();
  reader->rewind();
  invariant(read_through(*reader) == frames && reader->account().dropped == account.dropped,
            "a rewind changes nothing");
  replay(std::move(bytes), how % 4 < 2 ? ReplayPace::fast : ReplayPace::recorded, frames);
  return 0;
}
