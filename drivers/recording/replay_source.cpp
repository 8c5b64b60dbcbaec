#include "drivers/recording/replay_source.hpp"

#include <algorithm>
#include <utility>

#include "hal/try.hpp"

namespace compueye::recording {

hal::Result<std::unique_ptr<ReplaySource>> ReplaySource::open(const std::string& path, ReplayPace pace,
                                                              hal::Clock& clock) {
  auto recording = TRY(RecordingReader::open(path));
  return std::make_unique<ReplaySource>(std::move(recording), pace, clock);
}

ReplaySource::ReplaySource(RecordingReader recording, ReplayPace pace, hal::Clock& clock)
    : recording_(std::move(recording)), pace_(pace), clock_(clock), description_(recording_.header().source) {
  description_.backend = "replay";
}

hal::Result<void> ReplaySource::do_start() {
  recording_.rewind();
  next_.reset();
  account_ = {};
  faults_ = 0;
  started_ns_ = clock_.now_ns();
  return {};
}

hal::Result<hal::SampleBlock> ReplaySource::do_read(std::int64_t deadline_ns) {
  if (!next_) {
    auto frame = recording_.next();
    faults_.store(recording_.damage().stretches, std::memory_order_relaxed);
    if (!frame) {
      if (frame.error().code == hal::ErrorCode::end_of_stream) account_ = recording_.account();
      return tl::unexpected(std::move(frame.error()));
    }
    next_ = *frame;
  }
  if (pace_ == ReplayPace::recorded) {
    for (;;) {
      // As a difference: an arrival may lie further ahead than the Clock can tell.
      const std::int64_t now_ns = clock_.now_ns(), since_start_ns = now_ns - started_ns_;
      if (since_start_ns >= next_->arrival_ns) break;
      if (now_ns >= deadline_ns) return hal::timed_out();
      const std::int64_t wait_ns = next_->arrival_ns - since_start_ns;
      clock_.sleep_until_ns(wait_ns < deadline_ns - now_ns ? now_ns + wait_ns : deadline_ns);
    }
  }
  const hal::SampleBlock block = next_->block;
  next_.reset();
  account_ = recording_.account();
  return block;
}

std::vector<hal::Counter> ReplaySource::do_counters() const {
  const RecordingDamage& damage = recording_.damage();
  return {{"damaged_stretches", "pieces of the file between whole blocks that are none", damage.stretches},
          {"damaged_bytes", "bytes in them", damage.bytes, false},
          {"damaged_frames", "frames lost in them", damage.blocks, false},
          {"torn_bytes", "of a last block that was never finished", damage.torn_bytes, false},
          {"unrecorded_frames", "frames that the recording was too slow for", recording_.unrecorded(), false}};
}

}  // namespace compueye::recording
