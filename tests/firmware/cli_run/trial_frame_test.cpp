#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>

#include "firmware/operating_points/deadline_choice.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/hal/reference_source.hpp"

using namespace compueye;
using namespace compueye::firmware;

namespace {

/// Dark until a frame, bright from there on.
class DawnSource final : public hal::tests::ReferenceSource {
 public:
  DawnSource(hal::Clock& clock, std::uint64_t dawn, std::optional<std::uint64_t> length = std::nullopt)
      : ReferenceSource(clock, length), dawn_(dawn) {}

  bool blinding = false;

 protected:
  hal::SampleBlock make_block(bool overrun) override {
    hal::SampleBlock block = ReferenceSource::make_block(overrun);
    std::fill(codes_.begin(), codes_.end(), blinding ? 1023 : block.frame < dawn_ ? 0 : 500);
    return block;
  }

 private:
  std::uint64_t dawn_;
};

struct Trial {
  hal::VirtualClock clock;
  std::atomic<bool> stop{false};
  Board board;
  CorrectionSettings settings;

  Trial() {
    board.name = "dawn";
    board.source.frame_rate_hz = 1000.0;
    board.sensor.full_scale = 1023.0;
  }
  hal::Result<TrialFrame> take(hal::SampleSource& source) {
    return take_trial_frame(board, settings, source, clock, stop,
                            [](const TrialFrame& frame) { return frame.y.front() > 100.0F; });
  }
};

}  // namespace

TEST_CASE("the trial frame is the first that is wanted, where the first frames are dark") {
  Trial trial;
  DawnSource source(trial.clock, 3);
  const auto frame = trial.take(source);
  REQUIRE(frame.has_value());
  CHECK(frame->wanted);
  CHECK(frame->taken == 4);
  CHECK(frame->y.front() == 500.0F);
}

TEST_CASE("a source that stays dark or ends gives what it has, as not wanted") {
  for (const std::uint64_t length : {1000U, 5U}) {
    Trial trial;
    DawnSource source(trial.clock, 2000, length);
    const auto frame = trial.take(source);
    REQUIRE(frame.has_value());
    CHECK_FALSE(frame->wanted);
    CHECK(frame->taken == (length == 5U ? 5 : most_trial_frames));
    CHECK(frame->y.front() == 0.0F);
  }
}

TEST_CASE("frames of which none can be used are an error that says why") {
  Trial trial;
  DawnSource source(trial.clock, 0);
  source.blinding = true;
  const auto frame = trial.take(source);
  REQUIRE_FALSE(frame.has_value());
  CHECK(frame.error().code == hal::ErrorCode::mismatch);
  CHECK(test::names(frame.error().text(), "full_scale"));
}
