#include "studies/accuracy_and_time/scenes.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "calib/plausible_response.hpp"
#include "tests/studies/boards.hpp"

using namespace compueye;
using namespace compueye::firmware;
using compueye::test::board_8x8;

namespace {

std::vector<EvaluationScene> scenes_of(const Board& board, const std::vector<std::string>& names, bool moving = false) {
  auto scenes = make_evaluation_scenes(board, names, moving, test::go_on);
  REQUIRE(scenes.has_value());
  return *scenes;
}

}  // namespace

TEST_CASE("of an eye whose rows were measured the signals are what these make of the pictures") {
  const Board board = board_8x8();
  const auto rows = calib::plausible_response(board.eye, board.object, {}, 1).value();
  const auto scenes = make_evaluation_scenes(board, {"dots"}, true, test::go_on, &rows);
  REQUIRE(scenes.has_value());
  const EvaluationScene &scene = scenes->front(), drawn = scenes_of(board, {"dots"}).front();
  CHECK(scene.truth.pixels == drawn.truth.pixels);
  REQUIRE(scene.moving.size() == moving_frames);
  double off = 0.0;
  for (int m = 0; m < 64; ++m) {
    double sum = 0.0;
    rows.for_each_in_row(
        m, [&](std::int32_t n, double a) { sum += a * double{scene.truth.pixels[static_cast<std::size_t>(n)]}; });
    CHECK(scene.signals[static_cast<std::size_t>(m)] == doctest::Approx(sum));
    off = std::max(off, std::abs(sum - drawn.signals[static_cast<std::size_t>(m)]));
  }
  CHECK(off > 0.05);
}

TEST_CASE("a dozen scenes of different seeds, none of which a rule was fitted on") {
  const auto scenes = scenes_of(board_8x8(), {"line-art", "phantom", "dots"});
  REQUIRE(scenes.size() >= 12);
  std::set<std::uint64_t> seeds;
  std::set<std::vector<float>> pictures;
  for (const EvaluationScene& scene : scenes) {
    seeds.insert(scene.seed);
    pictures.insert(scene.truth.pixels);
    CHECK(scene.seed > 1100);  // tuning has 1001 and a handful, evaluation of the rules 1 to 5, boards 0
    CHECK(scene.signals.size() == 64);
  }
  CHECK(seeds.size() == scenes.size());
  CHECK(pictures.size() == scenes.size());
  CHECK(scenes[0].name == "line-art");
  CHECK(scenes[1].name == "phantom");
  CHECK(scenes[3].name == "line-art");
}

TEST_CASE("the noise of the samples is the level's sigma, rounding included") {
  const Board board = board_8x8();
  const auto scenes = scenes_of(board, {"dots"});
  const std::vector<std::uint8_t> sees(64, 1);
  for (const double times : {1.0, 4.0, 16.0}) {
    const NoiseLevel level{times, times * board.noise_sigma()};
    const auto frames = take_frames(board, scenes, sees, level, Motion::none);
    REQUIRE(frames.has_value());
    REQUIRE(frames->size() == scenes.size());
    double squares = 0.0, count = 0.0;
    for (std::size_t s = 0; s < scenes.size(); ++s) {
      for (std::size_t m = 0; m < 64; ++m) {
        CHECK((*frames)[s].back().weights[m] == 1.0F);
        const double noise = (*frames)[s].back().y[m] - scenes[s].signals[m];
        squares += noise * noise;
        count += 1.0;
      }
    }
    CHECK(std::sqrt(squares / count) == doctest::Approx(level.sigma).epsilon(0.1));
  }
}

TEST_CASE("dead ommatidia have no weight") {
  Board board = board_8x8();
  board.sensor.dead = {3, 40};
  const auto frames = take_frames(board, scenes_of(board, {"dots"}), std::vector<std::uint8_t>(64, 1),
                                  {1.0, board.noise_sigma()}, Motion::none);
  REQUIRE(frames.has_value());
  CHECK(frames->front().back().weights[3] == 0.0F);
  CHECK(frames->front().back().weights[40] == 0.0F);
  CHECK(frames->front().back().weights[4] == 1.0F);
}

TEST_CASE("scenes that do not exist or never change are refused, and a stop stops") {
  const Board board = board_8x8();
  for (const char* name : {"fig2", "lineart", "a.png"}) {
    const auto refused = make_evaluation_scenes(board, {name}, false, test::go_on);
    REQUIRE_FALSE(refused.has_value());
    CHECK(refused.error().code == hal::ErrorCode::usage);
    CHECK(refused.error().place == "--scenes");
  }
  const auto stopped =
      make_evaluation_scenes(board, {"dots"}, false, [](std::string_view, double, double) { return false; });
  REQUIRE_FALSE(stopped.has_value());
  CHECK(stopped.error().code == hal::ErrorCode::interrupted);
}

TEST_CASE("an eye with few pixels is shown dots, one with many drawings") {
  Board board = board_8x8();
  CHECK(usual_scenes(board) == std::vector<std::string>{"dots"});
  board.object.rows = board.object.cols = 160;
  CHECK(usual_scenes(board).size() == 3);
}

TEST_CASE("a sequence ends with the frame that a cold start is judged on, whatever happened before") {
  const Board board = board_8x8();
  const auto scenes = scenes_of(board, {"dots"}, true);
  const std::vector<std::uint8_t> sees(64, 1);
  const NoiseLevel level{4.0, 4.0 * board.noise_sigma()};
  const auto cold = take_frames(board, scenes, sees, level, Motion::none);
  const auto still = take_frames(board, scenes, sees, level, Motion::still);
  const auto sprite = take_frames(board, scenes, sees, level, Motion::sprite);
  REQUIRE(cold.has_value());
  REQUIRE(still.has_value());
  REQUIRE(sprite.has_value());
  for (std::size_t s = 0; s < scenes.size(); ++s) {
    REQUIRE((*cold)[s].size() == 1);
    REQUIRE((*still)[s].size() == sequence_frames);
    REQUIRE((*sprite)[s].size() == sequence_frames);
    CHECK((*still)[s].back().y == (*cold)[s].back().y);
    CHECK((*sprite)[s].back().y == (*cold)[s].back().y);
    CHECK((*still)[s][0].y != (*still)[s][1].y);  // fresh noise
    CHECK(scenes[s].moving.size() == moving_frames);
  }
}

TEST_CASE("a piece of the scene comes in from the right, and nothing else changes") {
  hal::Image scene(16, 16);
  for (int row = 0; row < 16; ++row) {
    for (int col = 0; col < 16; ++col) scene.at(row, col) = static_cast<float>(row * 16 + col) / 256.0F;
  }
  CHECK(before_arrival(scene, 0).pixels == scene.pixels);
  const hal::Image two = before_arrival(scene, 2);
  CHECK(two.at(7, 6) == 0.0F);
  CHECK(two.at(7, 8) == scene.at(7, 6));
  CHECK(two.at(7, 11) == scene.at(7, 9));
  CHECK(two.at(7, 12) == scene.at(7, 12));
  CHECK(two.at(5, 8) == scene.at(5, 8));
  CHECK(before_arrival(scene, 1000).at(7, 8) == 0.0F);
}
