#include "tests/firmware/pipeline/scripted_source.hpp"

namespace compueye::firmware::tests {

using hal::ErrorCode;
using hal::fail;

ScriptedSource::ScriptedSource(hal::Clock& clock, int channels)
    : clock_(clock), codes_(static_cast<std::size_t>(channels)), valid_(static_cast<std::size_t>(channels)) {
  description.backend = "scripted";
  description.serial = "scripted-1";
  description.channels = channels;
  description.bits = bits;
  description.frame_rate_hz = 1000.0;
  for (int c = 0; c < channels; ++c) {
    // Reversed, so that a map that is not applied shows.
    description.ommatidium_of_channel.push_back(channels - 1 - c);
  }
}

hal::Result<void> ScriptedSource::do_start() {
  if (!may_start) return fail(ErrorCode::io, description.serial, "refused to start");
  account_ = {};
  index_ = next_ = 0;
  timeouts_done_ = 0;
  began_ns_ = clock_.now_ns();
  return {};
}

void ScriptedSource::do_stop() noexcept {
  account_.produced += frames_lost_at_stop;
  account_.drops(hal::DropReason::stopped) += frames_lost_at_stop;
}

hal::FrameAccount ScriptedSource::do_account() const noexcept {
  hal::FrameAccount account = account_;
  if (lies_about_its_account) ++account.produced;
  return account;
}

hal::Result<hal::SampleBlock> ScriptedSource::do_read(std::int64_t deadline_ns) {
  if (before_read) before_read(index_);
  if (index_ >= length) return at_the_end(deadline_ns);
  const ScriptedFrame plan = script ? script(index_) : ScriptedFrame{};
  if (timeouts_done_ < plan.timeouts_before) {
    ++timeouts_done_;
    clock_.sleep_until_ns(deadline_ns);
    return hal::timed_out();
  }
  timeouts_done_ = 0;
  return block(plan);
}

hal::Result<hal::SampleBlock> ScriptedSource::at_the_end(std::int64_t deadline_ns) {
  switch (ending) {
    case ScriptEnd::disconnect:
      return fail(ErrorCode::disconnected, description.serial, "the eye was unplugged");
    case ScriptEnd::interrupted:
      return fail(ErrorCode::interrupted, description.serial, "the user asked to stop");
    case ScriptEnd::silence:
      clock_.sleep_until_ns(deadline_ns);
      return hal::timed_out();
    case ScriptEnd::end_of_stream:
      break;
  }
  return hal::stream_ended();
}

hal::SampleBlock ScriptedSource::block(const ScriptedFrame& plan) {
  next_ += plan.lost_before;
  account_.produced += plan.lost_before + 1;
  account_.drops(plan.lost_as) += plan.lost_before;
  ++account_.delivered;

  const std::uint64_t frame = next_++;
  ++index_;
  for (std::size_t c = 0; c < codes_.size(); ++c) {
    const bool saturated = c + static_cast<std::size_t>(plan.saturated_channels) >= codes_.size();
    codes_[c] = saturated ? (1 << bits) - 1 : code(frame, c);
    valid_[c] = c < static_cast<std::size_t>(plan.invalid_channels) ? 0 : 1;
  }
  hal::SampleBlock block;
  block.codes = std::span(codes_).first(codes_.size() - static_cast<std::size_t>(plan.short_by));
  block.valid = std::span(valid_).first(valid_.size() - static_cast<std::size_t>(plan.short_by));
  block.bits = bits;
  block.frame = plan.repeats_number ? frame - 1 : frame;
  block.t_ns = began_ns_ + static_cast<std::int64_t>(frame) * period_ns;
  block.config_id = plan.config_id;
  block.flags = plan.flags;
  if (period_ns > 0) clock_.sleep_until_ns(block.t_ns + period_ns);
  return block;
}

}  // namespace compueye::firmware::tests
