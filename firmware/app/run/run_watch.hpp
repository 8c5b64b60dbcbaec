#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <thread>

#include "firmware/app/run/frame_keeper.hpp"
#include "recon/setup/factor.hpp"

namespace compueye::firmware {

/// Shows on stderr how far a run is, from a thread of its own, so that the frame path neither writes nor allocates for
/// it. From construction to destruction.
class RunWatch {
 public:
  /// `frames` to deliver, 0 = unknown. `keeper` must outlive the watch, which alone uses `progress` meanwhile.
  RunWatch(const FrameKeeper& keeper, std::uint64_t frames, recon::Progress progress);
  RunWatch(const RunWatch&) = delete;
  RunWatch& operator=(const RunWatch&) = delete;
  ~RunWatch();

 private:
  void watch(std::uint64_t frames);

  const FrameKeeper& keeper_;
  recon::Progress progress_;
  std::mutex mutex_;
  std::condition_variable ended_;
  bool over_ = false;
  std::thread thread_;
};

}  // namespace compueye::firmware
