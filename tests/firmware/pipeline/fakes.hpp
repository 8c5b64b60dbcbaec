#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <functional>
#include <set>
#include <vector>

#include "firmware/pipeline/frame_observer.hpp"
#include "firmware/pipeline/frame_solver.hpp"
#include "hal/clock.hpp"
#include "hal/frame_sink.hpp"

namespace compueye::firmware::tests {

/// A picture of two rows: the samples and their weights, so that a sink sees what the solver was given.
class CopyingSolver final : public FrameSolver {
 public:
  CopyingSolver(hal::Clock& clock, int channels) : clock_(clock), channels_(channels) {}

  std::function<std::int64_t(std::uint64_t call)> takes_ns;    ///< time that the call-th frame takes
  std::function<recon::Health(std::uint64_t call)> health_of;  ///< empty: budget_used
  std::function<void(std::uint64_t call)> before_solve;        ///< on the solver thread
  std::atomic<std::uint64_t> calls{0};

  [[nodiscard]] int channels() const noexcept override { return channels_; }
  [[nodiscard]] hal::FrameFormat format() const noexcept override { return {2, channels_}; }

  recon::FrameInfo solve(std::span<const float> y, std::span<const float> weights,
                         std::span<float> x) noexcept override {
    const std::uint64_t call = calls++;
    if (before_solve) before_solve(call);
    std::copy(y.begin(), y.end(), x.begin());
    std::copy(weights.begin(), weights.end(), x.begin() + static_cast<std::ptrdiff_t>(y.size()));
    if (takes_ns) clock_.sleep_until_ns(clock_.now_ns() + takes_ns(call));
    recon::FrameInfo info;
    info.health = health_of ? health_of(call) : recon::Health::budget_used;
    info.iterations = static_cast<int>(call) + 1;
    info.channels_used = static_cast<int>(std::count(weights.begin(), weights.end(), 1.0F));
    return info;
  }

 private:
  hal::Clock& clock_;
  int channels_;
};

/// Remembers what came; refuses what it is told to.
class RecordingSink final : public hal::FrameSink {
 public:
  RecordingSink() { frames.reserve(100'000); }

  std::vector<std::uint64_t> frames;  ///< numbers of the frames taken
  std::set<std::uint64_t> refuses;    ///< calls of write(), from 0, that fail
  std::function<void(const hal::Frame&)> on_write;
  bool may_open = true;
  bool may_close = true;
  int opened = 0;
  int closed = 0;
  std::uint64_t writes = 0;
  hal::FrameFormat format;

  hal::Result<void> open(hal::FrameFormat format_) override {
    if (!may_open) return hal::fail(hal::ErrorCode::io, "out", "the folder cannot be written");
    ++opened;
    format = format_;
    frames.clear();
    writes = 0;
    return {};
  }
  hal::Result<void> write(const hal::Frame& frame) override {
    if (refuses.count(writes++) != 0) return hal::fail(hal::ErrorCode::no_space, "out/3.png", "the disk is full");
    frames.push_back(frame.frame);
    if (on_write) on_write(frame);
    return {};
  }
  hal::Result<void> close() override {
    ++closed;
    if (!may_close) return hal::fail(hal::ErrorCode::io, "out/x.npy", "the header could not be written");
    return {};
  }
};

}  // namespace compueye::firmware::tests
