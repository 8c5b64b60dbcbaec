#include "firmware/app/commands/frame_keeper.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace compueye::firmware {
namespace {

constexpr std::size_t least_capacity = 2;
constexpr std::uint64_t usual_capacity = 1024;

}  // namespace

FrameKeeper::FrameKeeper(hal::FrameFormat format, std::uint64_t expected, std::size_t most_bytes)
    : pixels_(static_cast<std::size_t>(format.rows) * static_cast<std::size_t>(format.cols)) {
  const std::size_t fit = most_bytes / (pixels_ * sizeof(float));
  const std::uint64_t wanted = expected > 0 ? std::min(expected, usual_capacity) : usual_capacity;
  capacity_ = std::max(least_capacity, std::min(fit, static_cast<std::size_t>(wanted)));
  pictures_.resize(capacity_ * pixels_);
  frames_.resize(capacity_);
  last_.resize(pixels_);
}

std::span<float> FrameKeeper::slot(std::size_t index) noexcept {
  return std::span(pictures_).subspan(index * pixels_, pixels_);
}

std::span<const float> FrameKeeper::picture(std::size_t index) const noexcept {
  return std::span(pictures_).subspan(index * pixels_, pixels_);
}

void FrameKeeper::published(const PublishedFrame& published) noexcept {
  const std::span<const float> pixels = published.frame.pixels;
  std::copy(pixels.begin(), pixels.end(), last_.begin());
  last_frame_ = published.frame.frame;
  const std::uint64_t index = published.delivered - 1;
  status_.published(published.frame.frame, published.age_ns, published.late);
  if (index % stride_ != 0) return;
  if (kept_ == capacity_) {
    for (std::size_t i = 1; 2 * i < kept_; ++i) {
      std::copy_n(picture(2 * i).begin(), pixels_, slot(i).begin());
      frames_[i] = frames_[2 * i];
    }
    kept_ = (kept_ + 1) / 2;
    stride_ *= 2;
    if (index % stride_ != 0) return;
  }
  std::copy(pixels.begin(), pixels.end(), slot(kept_).begin());
  frames_[kept_] = last_frame_;
  ++kept_;
}

RunWatch::RunWatch(std::function<void()> tell) : tell_(std::move(tell)), thread_([this] { watch(); }) {}

RunWatch::~RunWatch() {
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
  }
  ended_.notify_all();
  thread_.join();
}

void RunWatch::watch() {
  constexpr std::chrono::milliseconds every{100};
  std::unique_lock lock(mutex_);
  while (!ended_.wait_for(lock, every, [this] { return over_; })) tell_();
}

}  // namespace compueye::firmware
