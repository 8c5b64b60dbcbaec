#include "studies/accuracy_and_time/sweep.hpp"

#include <doctest/doctest.h>

#include "studies/accuracy_and_time/scenes.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/studies/boards.hpp"

using namespace compueye;
using namespace compueye::firmware;

namespace {

SweepOptions little() {
  SweepOptions options;
  options.quick = true;
  options.solvers = {"tikhonov", "cp"};
  options.bases = {"identity"};
  options.noise = {1.0, 4.0};
  return options;
}

hal::Result<Sweep> swept(const SweepOptions& options, hal::VirtualClock& clock, const recon::Progress& progress) {
  const test::TemporaryFolder folder;
  Board board = test::board_8x8();
  board.folder = folder.path();
  return sweep(board, options, clock, progress);
}

}  // namespace

TEST_CASE("a sweep has every planned point at every noise level, and says what it was measured with") {
  hal::VirtualClock clock;
  const auto sweep = swept(little(), clock, test::go_on);
  REQUIRE(sweep.has_value());
  CHECK(sweep->cut_short.empty());
  CHECK(sweep->planned == 3);  // tikhonov once, cp at two numbers of iterations
  CHECK(sweep->points.size() == 3);
  CHECK(sweep->conventional.size() == 2);
  CHECK(sweep->first_scene_seed == first_evaluation_seed);
  CHECK(sweep->pictures_a_level == evaluation_scenes);
  CHECK(sweep->machine == this_machine());
  for (const MeasuredPoint& point : sweep->points) {
    REQUIRE(point.levels.size() == 2);
    CHECK(point.levels[1].sigma == doctest::Approx(4.0 * point.levels[0].sigma));
    CHECK(point.levels[1].lambda > point.levels[0].lambda);
    CHECK(point.timed_frames > 0);
  }
}

TEST_CASE("a stop keeps the points that were measured; before the first it is an error") {
  hal::VirtualClock clock;
  int asked = 0;
  const auto some = swept(little(), clock, [&](std::string_view what, double share, double) {
    return what != "measuring every point" || share == 0.0 || ++asked < 20;
  });
  REQUIRE(some.has_value());
  CHECK_FALSE(some->cut_short.empty());
  CHECK_FALSE(some->points.empty());
  CHECK(some->points.size() < some->planned);
  const auto none =
      swept(little(), clock, [](std::string_view what, double, double) { return what != "measuring every point"; });
  REQUIRE_FALSE(none.has_value());
  CHECK(none.error().code == hal::ErrorCode::interrupted);
}

TEST_CASE("a budget that is used up ends the sweep with what there is") {
  hal::VirtualClock clock;
  SweepOptions options = little();
  options.budget_s = 50.0;
  const auto sweep = swept(options, clock, [&](std::string_view what, double share, double) {
    if (what == "measuring every point" && share > 0.0) clock.advance(10'000'000'000);
    return true;
  });
  REQUIRE(sweep.has_value());
  test::check_sentence(sweep->cut_short, {"50", "--budget"});
  CHECK(sweep->points.size() < sweep->planned);
}
