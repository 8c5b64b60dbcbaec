#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>

#include "firmware/pipeline/pipeline.hpp"
#include "hal/clock.hpp"
#include "tests/firmware/pipeline/fakes.hpp"
#include "tests/firmware/pipeline/scripted_source.hpp"

namespace compueye::firmware::tests {

/// Source, solver and sink around a pipeline in virtual time. The sink checks that every picture is made from the
/// samples of the frame whose number it carries.
struct Rig {
  static constexpr int channels = 20;

  hal::VirtualClock clock;
  ScriptedSource source{clock, channels};
  CopyingSolver solver{clock, channels};
  RecordingSink sink;
  PipelineSettings settings;
  std::atomic<bool> stop{false};
  std::uint64_t wrong_pictures = 0;

  Rig() {
    settings.pacing = Pacing::every_frame;
    sink.on_write = [this](const hal::Frame& frame) {
      if (!belongs(frame)) ++wrong_pictures;
    };
  }

  [[nodiscard]] static bool belongs(const hal::Frame& frame) {
    const auto m = static_cast<std::size_t>(channels);
    for (std::size_t c = 0; c < m; ++c) {
      const float weight = frame.pixels[m + (m - 1 - c)];
      const float expected = weight == 0.0F ? 0.0F : static_cast<float>(ScriptedSource::code(frame.frame, c));
      if (frame.pixels[m - 1 - c] != expected) return false;
    }
    return frame.pixels.size() == 2 * m;
  }

  RunSummary run(FrameObserver* observer = nullptr) {
    auto pipeline = Pipeline::create(settings, source, solver, sink, clock, observer);
    REQUIRE_MESSAGE(pipeline.has_value(), pipeline.error().text());
    return checked(pipeline->run(stop));
  }

  /// What holds for every run, however it went.
  RunSummary checked(RunSummary summary) {
    CHECK(summary.frames.balanced());
    CHECK(summary.frames.delivered == sink.frames.size());
    CHECK(wrong_pictures == 0);
    // Strictly rising: in order and without a repeat.
    CHECK(std::adjacent_find(sink.frames.begin(), sink.frames.end(), std::greater_equal<>()) == sink.frames.end());
    CHECK(summary.age.count == summary.frames.delivered);
    CHECK(summary.last.has_value() == (summary.frames.delivered > 0));
    CHECK_FALSE(source.started());
    return summary;
  }
};

/// Lets one thread wait until another has come so far.
class Progress {
 public:
  void reach(std::uint64_t value) {
    {
      const std::lock_guard lock(mutex_);
      value_ = std::max(value_, value);
    }
    moved_.notify_all();
  }
  void wait_for(std::uint64_t value) {
    std::unique_lock lock(mutex_);
    moved_.wait(lock, [&] { return value_ >= value; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable moved_;
  std::uint64_t value_ = 0;
};

}  // namespace compueye::firmware::tests
