// The frames of device::ConverterSource.

#include "drivers/device/converter_source.hpp"

#include <algorithm>
#include <utility>

#include "hal/try.hpp"

namespace compueye::device {
namespace {

using frontend::ChipFault;
using hal::DropReason;

// Edges looked at before the deadline is looked at again: a line that oscillates brings them without end.
constexpr int most_edges_at_once = 64;
constexpr int most_edges_left = 4096;
constexpr int most_bad_frames = 3;
// A line that oscillates has a first edge after every restart, which looks like a frame's.
constexpr int frames_that_prove = 3;

/// A row a ChipFault but none.
constexpr std::array fault_rows{ConverterFailure::crc_error,     ConverterFailure::wrong_place,
                                ConverterFailure::stuck_low,     ConverterFailure::stuck_high,
                                ConverterFailure::lost_settings, ConverterFailure::no_new_sample};
static_assert(fault_rows.size() + 1 == frontend::chip_fault_count);

}  // namespace

hal::Result<hal::SampleBlock> ConverterSource::do_read(std::int64_t deadline_ns) {
  auto block = read_or_recover(deadline_ns);
  faults_.store(failures_.faults(), std::memory_order_relaxed);
  return block;
}

hal::Result<hal::SampleBlock> ConverterSource::read_or_recover(std::int64_t deadline_ns) {
  for (;;) {
    if (given_up_) {
      return hal::fail(hal::ErrorCode::disconnected, description_.serial,
                       "gives no frames any more: " + last_error_.text());
    }
    if (!streaming_) {
      recover(deadline_ns);
    } else if (const auto due = wires_.ready ? wait_for_edge(deadline_ns) : wait_for_turn(deadline_ns)) {
      if (const auto block = read_frame(*due)) return *block;
    }
    if (!given_up_ && clock_.now_ns() >= deadline_ns) return hal::timed_out();
  }
}

void ConverterSource::drop(std::uint64_t frames, DropReason reason) noexcept {
  account_.produced += frames;
  account_.drops(reason) += frames;
  if (reason == DropReason::device_overrun) overruns_ += frames;
}

/// The frames before this edge's, and it itself in frame_edge_ when it is of one.
void ConverterSource::saw_edge(const hal::Edge& edge, DropReason untaken) noexcept {
  const EdgePace::Seen seen = pace_.saw(edge);
  failures_[ConverterFailure::spurious_edge] += seen.spurious;
  if (!seen.frame) return;
  const std::uint64_t late = seen.late + (frame_edge_ ? 1 : 0);
  failures_[ConverterFailure::late_host] += late;
  failures_[ConverterFailure::missed_edge] += seen.unsaid;
  drop(late, untaken);
  drop(seen.unsaid, DropReason::transport_gap);
  account_.estimated += seen.estimated;
  frame_edge_.reset();
  if (!seen.unclear) {
    frame_edge_ = edge;
    return;
  }
  ++failures_[ConverterFailure::unclear_edge];
  drop(1, DropReason::transport_gap);
}

/// The newest conversion: what the chips hold is its.
std::optional<ConverterSource::Due> ConverterSource::wait_for_edge(std::int64_t deadline_ns) {
  for (int edges = 0; edges < most_edges_at_once; ++edges) {
    const std::int64_t silent_ns = last_frame_ns_ + silence_ns_;
    const auto edge = wires_.ready->wait(frame_edge_ ? clock_.now_ns() : std::min(deadline_ns, silent_ns));
    if (edge) {
      saw_edge(*edge, DropReason::device_overrun);
      continue;
    }
    if (edge.error().code != hal::ErrorCode::timeout) {
      count_failed(edge.error());
      lose_stream(edge.error());
      return std::nullopt;
    }
    break;
  }
  if (!frame_edge_) {
    if (clock_.now_ns() >= last_frame_ns_ + silence_ns_) {
      ++failures_[ConverterFailure::silence];
      lose_stream(
          {hal::ErrorCode::timeout, wires_.ready->name(), "does not say that data are ready, or says it without end"});
    }
    return std::nullopt;
  }
  const std::int64_t t_ns = std::exchange(frame_edge_, std::nullopt)->t_ns;
  return Due{t_ns - period_ns_, pace_.next_ns().value_or(t_ns + period_ns_)};
}

/// The host's own turn; those that are over are lost.
std::optional<ConverterSource::Due> ConverterSource::wait_for_turn(std::int64_t deadline_ns) {
  if (turn_ns_ > deadline_ns) {
    clock_.sleep_until_ns(deadline_ns);
    return std::nullopt;
  }
  clock_.sleep_until_ns(turn_ns_);
  const std::int64_t now_ns = clock_.now_ns();
  const std::int64_t over = (now_ns - turn_ns_) / period_ns_;
  if (over > 0) {
    failures_[ConverterFailure::late_host] += static_cast<std::uint64_t>(over);
    drop(static_cast<std::uint64_t>(over), DropReason::device_overrun);
  }
  turn_ns_ += (over + 1) * period_ns_;
  return Due{now_ns, now_ns + period_ns_};
}

hal::Result<void> ConverterSource::exchange() {
  if (wires_.sync) TRY(wires_.sync->set(1));
  auto moved = exchange_all();
  if (wires_.sync) {
    auto low = wires_.sync->set(0);
    if (moved && !low) return low;
  }
  return moved;
}

hal::Result<void> ConverterSource::exchange_all() {
  for (const frontend::Exchange& each : front_end_->frame()) {
    if (wires_.select) TRY(wires_.select->set(each.select));
    TRY(wires_.data->exchange(each.segments));
  }
  return {};
}

void ConverterSource::count_chips(const frontend::FrameReport& report) noexcept {
  for (std::size_t k = 0; k < fault_rows.size(); ++k) failures_[fault_rows[k]] += report.chips[k + 1];
}

std::optional<hal::SampleBlock> ConverterSource::read_frame(const Due& due) {
  if (auto moved = exchange(); !moved) {
    count_failed(moved.error());
    drop(1, DropReason::transport_gap);
    lose_stream(std::move(moved.error()));
    return std::nullopt;
  }
  const frontend::FrameReport report = front_end_->decode(codes_, valid_);
  const std::int64_t now_ns = clock_.now_ns();
  last_frame_ns_ = now_ns;
  count_chips(report);
  if (wires_.ready && now_ns > due.until_ns) {
    ++failures_[ConverterFailure::torn_frame];
    drop(1, DropReason::device_overrun);
    return std::nullopt;
  }
  const int good = report.with(ChipFault::none), chips = settings_.front_end.chips;
  const bool settings_lost = report.with(ChipFault::lost_settings) > 0;
  bad_frames_ = good == 0 ? bad_frames_ + 1 : 0;
  std::optional<hal::SampleBlock> block;
  if (good == 0) {
    drop(1, DropReason::corrupt);
  } else {
    failures_[ConverterFailure::incomplete_frame] += good < chips ? 1 : 0;
    block = block_of(due);
  }
  if (settings_lost) {
    lose_stream({hal::ErrorCode::stale, description_.serial, "a chip has started anew and lost its settings"});
  } else if (bad_frames_ >= most_bad_frames) {
    lose_stream({hal::ErrorCode::bad_format, description_.serial,
                 "no chip answers as its kind does; look at the wires and the supply"});
  }
  return block;
}

hal::SampleBlock ConverterSource::block_of(const Due& due) noexcept {
  hal::SampleBlock block;
  block.codes = codes_;
  block.valid = valid_;
  block.bits = settings_.chip->bits;
  block.frame = account_.produced;
  block.t_ns = due.t_ns;
  block.config_id = 1;
  block.flags.overrun = std::exchange(overruns_, 0) > 0;
  const std::int32_t most = static_cast<std::int32_t>((std::int64_t{1} << block.bits) - 1);
  block.flags.saturated = std::find(codes_.begin(), codes_.end(), most) != codes_.end();
  ++account_.produced;
  ++account_.delivered;
  if (++frames_of_stream_ >= frames_that_prove) {
    in_outage_ = false;
    recovering_.store(false, std::memory_order_relaxed);
  }
  return block;
}

/// Frames that are complete and were not asked for.
void ConverterSource::do_stop() noexcept {
  if (streaming_ && wires_.ready) {
    for (int edges = 0; edges < most_edges_left; ++edges) {
      const auto edge = wires_.ready->wait(clock_.now_ns());
      if (!edge) break;
      saw_edge(*edge, DropReason::stopped);
    }
    if (frame_edge_) drop(1, DropReason::stopped);
  }
  frame_edge_.reset();
  streaming_ = false;
  faults_.store(failures_.faults(), std::memory_order_relaxed);
}

}  // namespace compueye::device
