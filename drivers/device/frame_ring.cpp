#include "drivers/device/frame_ring.hpp"

#include <algorithm>

namespace compueye::device {

FrameRing::FrameRing(std::size_t slots, std::size_t channels) : slots_(std::max<std::size_t>(slots, 1)) {
  for (RingFrame& slot : slots_) {
    slot.codes.resize(channels);
    slot.valid.resize(channels);
  }
}

bool FrameRing::has_room() noexcept {
  const std::lock_guard lock(mutex_);
  return pushed_ - released_ < slots_.size();
}

bool FrameRing::push(const hal::SampleBlock& block, const SourceBooks& books) noexcept {
  // Nobody else touches a slot that is neither waiting nor in the reader's hand.
  RingFrame& slot = slots_[static_cast<std::size_t>(pushed_ % slots_.size())];
  if (block.codes.size() != slot.codes.size() || block.valid.size() != slot.valid.size()) return false;
  std::copy(block.codes.begin(), block.codes.end(), slot.codes.begin());
  std::copy(block.valid.begin(), block.valid.end(), slot.valid.begin());
  slot.block = block;
  slot.block.codes = slot.codes;
  slot.block.valid = slot.valid;
  slot.books = books;
  const std::lock_guard lock(mutex_);
  ++pushed_;
  return true;
}

const RingFrame* FrameRing::pop() noexcept {
  const std::lock_guard lock(mutex_);
  released_ = popped_;
  if (pushed_ == popped_) return nullptr;
  return &slots_[static_cast<std::size_t>(popped_++ % slots_.size())];
}

bool FrameRing::has_frame() noexcept {
  const std::lock_guard lock(mutex_);
  return pushed_ > popped_;
}

void FrameRing::clear() noexcept {
  const std::lock_guard lock(mutex_);
  pushed_ = popped_ = released_ = 0;
}

}  // namespace compueye::device
