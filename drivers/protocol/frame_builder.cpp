#include "drivers/protocol/frame_builder.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace compueye::protocol {

FrameBuilder::FrameBuilder(int channels, int bits)
    : channels_(static_cast<std::size_t>(std::clamp(channels, 1, most_channels))),
      bits_(std::clamp(bits, 1, 24)),
      come_(channels_) {
  for (Slot& slot : slots_) {
    slot.codes.resize(channels_);
    slot.valid.resize(channels_);
  }
}

void FrameBuilder::begin_run() noexcept {
  release();
  open_ = false;
  has_last_ = same_stream_ = false;
  sequence_.begin_run();
}

void FrameBuilder::begin_stream(std::int64_t period_ns) noexcept {
  period_ns_ = period_ns;
  same_stream_ = false;
  frames_below_ = std::numeric_limits<std::uint64_t>::max();
  sequence_.begin_stream();
}

void FrameBuilder::release() noexcept {
  for (; ready_ > 0; --ready_) {
    sequence_.drop(slots_[(current_ + ready_) % 2].gap, hal::DropReason::superseded);
  }
}

bool FrameBuilder::ends_open(std::int64_t device_frame) const noexcept {
  return open_ && device_frame >= 0 && sequence_.run_frame(static_cast<std::uint64_t>(device_frame)) > frame();
}

bool FrameBuilder::is_late(std::int64_t device_frame) const noexcept {
  if (device_frame < 0) return true;
  return sequence_.run_frame(static_cast<std::uint64_t>(device_frame)) < (open_ ? frame() : sequence_.next_frame());
}

void FrameBuilder::open(std::int64_t device_frame) noexcept {
  Slot& slot = slots_[current_];
  std::memset(slot.valid.data(), 0, channels_);
  std::memset(come_.data(), 0, channels_);
  slot.come = 0;
  slot.block = {};
  slot.block.frame = sequence_.run_frame(static_cast<std::uint64_t>(device_frame));
  slot.block.bits = bits_;
  slot.conditions = {};
  open_ = true;
}

bool FrameBuilder::overlaps(std::size_t first, std::size_t count) const noexcept {
  return slots_[current_].come > 0 && std::memchr(come_.data() + first, 1, count) != nullptr;
}

FrameBuilder::Part FrameBuilder::take_part(std::size_t first, std::size_t count) noexcept {
  Slot& slot = slots_[current_];
  if (count < channels_) std::memset(come_.data() + first, 1, count);
  slot.come += count;
  return {std::span(slot.codes).subspan(first, count), std::span(slot.valid).subspan(first, count)};
}

bool FrameBuilder::finish() noexcept {
  Slot& slot = slots_[current_];
  if (slot.come < channels_) {
    for (std::size_t k = 0; k < channels_; ++k) {
      if (come_[k] == 0) slot.codes[k] = 0;
    }
  }
  hal::SampleBlock& block = slot.block;
  block.codes = slot.codes;
  block.valid = slot.valid;
  slot.gap = sequence_.place(block.frame);
  block.flags.overrun = block.flags.overrun || slot.gap.overrun > 0;
  block.flags.time_ok = block.flags.time_ok && time_fits(block);
  last_t_ns_ = block.t_ns;
  last_frame_ = block.frame;
  has_last_ = same_stream_ = true;
  open_ = false;
  ++ready_;
  current_ ^= 1U;
  return slot.come == channels_;
}

void FrameBuilder::abandon(hal::DropReason reason) noexcept {
  for (; ready_ > 0; --ready_) sequence_.drop(slots_[(current_ + ready_) % 2].gap, reason);
  if (!open_) return;
  sequence_.drop(sequence_.place(frame()), reason);
  open_ = false;
}

void FrameBuilder::lose(std::uint64_t frames, hal::DropReason reason) noexcept {
  abandon(reason);
  sequence_.lose(frames, reason);
}

std::optional<hal::SampleBlock> FrameBuilder::take() noexcept {
  if (ready_ == 0) return std::nullopt;
  const Slot& slot = slots_[(current_ + ready_) % 2];
  --ready_;
  sequence_.deliver(slot.gap);
  taken_ = slot.conditions;
  return slot.block;
}

bool FrameBuilder::time_fits(const hal::SampleBlock& block) const noexcept {
  if (!has_last_) return true;
  if (block.t_ns <= last_t_ns_) return false;
  if (!same_stream_ || period_ns_ <= 0) return true;
  const auto period = static_cast<double>(period_ns_);
  const double expected = static_cast<double>(block.frame - last_frame_) * period;
  const double step = static_cast<double>(block.t_ns) - static_cast<double>(last_t_ns_);
  return std::abs(step - expected) < 0.25 * period + 0.02 * (expected - period);
}

}  // namespace compueye::protocol
