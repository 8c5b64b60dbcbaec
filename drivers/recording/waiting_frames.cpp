#include "drivers/recording/waiting_frames.hpp"

namespace compueye::recording {

WaitingFrames::WaitingFrames(std::size_t capacity, std::size_t channels) : slots_(capacity) {
  for (WaitingFrame& slot : slots_) {
    slot.codes.resize(channels);
    slot.valid.resize(channels);
  }
}

WaitingFrame* WaitingFrames::claim(bool wait) noexcept {
  std::unique_lock lock(mutex_);
  if (wait) room_.wait(lock, [this] { return pushed_ - done_ < slots_.size(); });
  return pushed_ - done_ < slots_.size() ? &slots_[static_cast<std::size_t>(pushed_ % slots_.size())] : nullptr;
}

void WaitingFrames::push() noexcept {
  {
    const std::lock_guard lock(mutex_);
    ++pushed_;
  }
  filled_.notify_one();
}

WaitingFrame* WaitingFrames::oldest() noexcept {
  std::unique_lock lock(mutex_);
  filled_.wait(lock, [this] { return closed_ || woken_ || pushed_ > done_; });
  woken_ = false;
  return pushed_ > done_ ? &slots_[static_cast<std::size_t>(done_ % slots_.size())] : nullptr;
}

void WaitingFrames::wake() noexcept {
  {
    const std::lock_guard lock(mutex_);
    woken_ = true;
  }
  filled_.notify_one();
}

bool WaitingFrames::drained() noexcept {
  const std::lock_guard lock(mutex_);
  return closed_ && pushed_ == done_;
}

void WaitingFrames::done() noexcept {
  {
    const std::lock_guard lock(mutex_);
    ++done_;
  }
  room_.notify_one();
}

void WaitingFrames::close() noexcept {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  filled_.notify_all();
}

}  // namespace compueye::recording
