#include "firmware/app/pareto/evaluation_scenes.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <set>

#include "recon/response.hpp"

using namespace compueye;
using namespace compueye::firmware;

namespace {

Board board_8x8() {
  auto board = load_board(std::filesystem::path(COMPUEYE_SOURCE_DIR) / "boards" / "sim-8x8");
  REQUIRE(board.has_value());
  return *board;
}

std::vector<EvaluationScene> scenes_of(const Board& board, const std::vector<std::string>& names) {
  auto scenes = make_evaluation_scenes(board, names, [](std::string_view, double, double) { return true; });
  REQUIRE(scenes.has_value());
  return *scenes;
}

}  // namespace

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
    const auto frames = take_frames(board, scenes, sees, level);
    REQUIRE(frames.has_value());
    REQUIRE(frames->size() == scenes.size());
    double squares = 0.0, count = 0.0;
    for (std::size_t s = 0; s < scenes.size(); ++s) {
      for (std::size_t m = 0; m < 64; ++m) {
        CHECK((*frames)[s].weights[m] == 1.0F);
        const double noise = (*frames)[s].y[m] - scenes[s].signals[m];
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
  const auto frames =
      take_frames(board, scenes_of(board, {"dots"}), std::vector<std::uint8_t>(64, 1), {1.0, board.noise_sigma()});
  REQUIRE(frames.has_value());
  CHECK(frames->front().weights[3] == 0.0F);
  CHECK(frames->front().weights[40] == 0.0F);
  CHECK(frames->front().weights[4] == 1.0F);
}

TEST_CASE("scenes that do not exist or never change are refused, and a stop stops") {
  const Board board = board_8x8();
  const auto on = [](std::string_view, double, double) { return true; };
  for (const char* name : {"fig2", "lineart", "a.png"}) {
    const auto refused = make_evaluation_scenes(board, {name}, on);
    REQUIRE_FALSE(refused.has_value());
    CHECK(refused.error().code == hal::ErrorCode::usage);
    CHECK(refused.error().place == "--scenes");
  }
  const auto stopped = make_evaluation_scenes(board, {"dots"}, [](std::string_view, double, double) { return false; });
  REQUIRE_FALSE(stopped.has_value());
  CHECK(stopped.error().code == hal::ErrorCode::interrupted);
}

TEST_CASE("an eye with few pixels is shown dots, one with many drawings") {
  Board board = board_8x8();
  CHECK(usual_scenes(board) == std::vector<std::string>{"dots"});
  board.object.rows = board.object.cols = 160;
  CHECK(usual_scenes(board).size() == 3);
}
