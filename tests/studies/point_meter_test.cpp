#include "studies/accuracy_and_time/point_meter.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "recon/solver_list.hpp"
#include "tests/studies/boards.hpp"

using namespace compueye;
using namespace compueye::firmware;

namespace {

struct Judged {
  double nmse = 0.0;
  double objective = 0.0;
};

/// pdhg in pixels on the 8x8 eye at the board's noise.
Judged judged(Motion motion, int iterations) {
  Board board = test::board_8x8();
  const recon::Progress on = test::go_on;
  const auto living = living_response(board, on);
  REQUIRE(living.has_value());
  const auto scenes = make_evaluation_scenes(board, {"dots"}, true, on);
  REQUIRE(scenes.has_value());
  const std::vector<NoiseLevel> levels{{1.0, board.noise_sigma()}};
  auto frames = take_frames(board, *scenes, living->sees, levels.front(), motion);
  REQUIRE(frames.has_value());
  const std::vector<std::vector<FrameSequence>> by_level{std::move(*frames)};
  Curve curve{recon::solver_named("pdhg"), recon::BasisKind::identity, recon::ConstraintKind::box,
              recon::Precision::f32};
  curve.motion = motion;
  const test::TemporaryFolder folder;  // for the factor
  board.folder = folder.path();
  auto eyes = set_up_curve(board, *living, curve, levels, on);
  REQUIRE_MESSAGE(eyes.has_value(), eyes.error().text());
  const hal::VirtualClock clock;
  const PointMeter meter(*scenes, levels, by_level, clock, [] { return true; });
  const auto point = meter.judge(curve, *eyes, iterations);
  REQUIRE(point.has_value());
  return {point->overall.mean.nmse, point->objective};
}

}  // namespace

TEST_CASE("frames that go on from the last one are better than cold ones of as many iterations where little moves") {
  constexpr int few = 5;
  const Judged cold = judged(Motion::none, few), still = judged(Motion::still, few);
  CHECK(still.nmse < 0.5 * cold.nmse);
  CHECK(still.objective < cold.objective);
  // Twelve frames of five iterations on a still scene come near sixty of one frame.
  CHECK(still.nmse < 2.0 * judged(Motion::none, few * static_cast<int>(sequence_frames)).nmse + 1e-4);
}

TEST_CASE("a piece that moves does not make a warm start worse than a cold one") {
  constexpr int few = 5;
  CHECK(judged(Motion::sprite, few).nmse < 1.2 * judged(Motion::none, few).nmse);
}

TEST_CASE("percentiles of frame times are those of the nearest rank") {
  FrameTimes times;
  CHECK(std::isnan(times.percentile_ms(500)));
  for (int i = 2000; i >= 1; --i) times.add(i * 1'000'000LL);
  CHECK(times.count() == 2000);
  CHECK(times.percentile_ms(500) == doctest::Approx(1000.0));
  CHECK(times.percentile_ms(999) == doctest::Approx(1998.0));
  CHECK(times.percentile_ms(1000) == doctest::Approx(2000.0));
}

TEST_CASE("with few frames the 99.9th percentile is the slowest of them") {
  FrameTimes times;
  for (const int ms : {3, 9, 1, 4}) times.add(ms * 1'000'000LL);
  CHECK(times.percentile_ms(999) == doctest::Approx(9.0));
  CHECK(times.percentile_ms(500) == doctest::Approx(3.0));
}
