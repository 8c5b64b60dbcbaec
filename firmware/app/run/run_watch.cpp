#include "firmware/app/run/run_watch.hpp"

#include <chrono>
#include <utility>

namespace compueye::firmware {

RunWatch::RunWatch(const FrameKeeper& keeper, std::uint64_t frames, recon::Progress progress)
    : keeper_(keeper), progress_(std::move(progress)), thread_([this, frames] { watch(frames); }) {}

RunWatch::~RunWatch() {
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
  }
  ended_.notify_all();
  thread_.join();
}

void RunWatch::watch(std::uint64_t frames) {
  constexpr std::chrono::milliseconds every{100};
  std::unique_lock lock(mutex_);
  while (!ended_.wait_for(lock, every, [this] { return over_; })) {
    progress_("frames", static_cast<double>(keeper_.delivered()), static_cast<double>(frames));
  }
}

}  // namespace compueye::firmware
