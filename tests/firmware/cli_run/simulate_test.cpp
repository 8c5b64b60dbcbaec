#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "firmware/eye/board.hpp"
#include "firmware/eye/ready_eye.hpp"
#include "firmware/files/npy.hpp"
#include "firmware/files/png.hpp"
#include "firmware/pipeline/reconstructor_solver.hpp"
#include "recon/metrics.hpp"
#include "sim/effects/effect.hpp"
#include "tests/firmware/cli_run/copied_board.hpp"

using namespace compueye;
using namespace compueye::test;

namespace {

firmware::SampleArray simulated(const CopiedBoard& board, std::vector<std::string> more) {
  const auto file = board.outside("y.npy");
  more.insert(more.begin(), {"simulate", "--board", board.path().string(), "--out", file.string()});
  const Ended ended = compueye::test::compueye(more);
  REQUIRE_MESSAGE(ended.exit_code == 0, ended.err);
  auto samples = firmware::read_samples(file, 64);
  REQUIRE(samples.has_value());
  return *samples;
}

}  // namespace

TEST_CASE("simulated samples reconstruct to the scene they were made from") {
  const CopiedBoard board;
  const auto truth_file = board.outside("x.npy");
  const auto samples = simulated(board, {"--truth", truth_file.string()});
  CHECK(samples.channels == 64);
  CHECK_FALSE(samples.has_frame_axis);
  const auto loaded = firmware::load_board(board.path());
  REQUIRE(loaded.has_value());
  const auto eye = firmware::ReadyEye::make(*loaded, {}, {});
  REQUIRE(eye.has_value());
  const std::vector<float> y(samples.values.begin(), samples.values.end());
  hal::Image picture(16, 16);
  firmware::ReconstructorSolver(eye->reconstructor()).solve(y, std::vector<float>(64, 1.0F), picture.pixels);
  const auto truths = firmware::read_pictures(truth_file);
  REQUIRE(truths.has_value());
  hal::Image truth(16, 16);
  REQUIRE(truths->values.size() == truth.pixels.size());
  std::copy(truths->values.begin(), truths->values.end(), truth.pixels.begin());
  CHECK(recon::nmse(picture, truth).value() < 1e-3);
}

TEST_CASE("the truth of a scene file is one picture when it is still, and one a frame when something moves") {
  const CopiedBoard board;
  const auto truth_file = board.outside("x.npy"), scene = board.outside("scene.toml");
  const auto truths_of = [&](const std::string& motion) {
    std::ofstream(scene) << "[[surface]]\npicture = \"white\"\nwidth_mm = 1\nx_mm = -3\n" << motion;
    const auto samples = simulated(board, {"--scene", scene.string(), "--frames", "3", "--truth", truth_file.string()});
    CHECK(samples.frames == 3);
    return firmware::read_pictures(truth_file).value();
  };
  CHECK(truths_of("").values.size() == 16 * 16);
  // 200 frames a second: 2.5, 7.5 and 12.5 ms after the beginning a bar of 1 mm is 0.5, 1.5 and 2.5 mm farther.
  const auto moving = truths_of("velocity_mm_per_s = [200, 0, 0]\n[scene]\nduration_s = 1\n");
  REQUIRE(moving.values.size() == 3 * 16 * 16);
  const double pixel_mm = 8.0 / 16;
  for (int frame = 0; frame < 3; ++frame) {
    double light = 0.0, moment = 0.0;
    for (int col = 0; col < 16; ++col) {
      const double value = static_cast<double>(moving.values[static_cast<std::size_t>(frame * 256 + 7 * 16 + col)]);
      light += value;
      moment += value * ((col + 0.5) * pixel_mm - 4.0);
    }
    CHECK(light * pixel_mm == doctest::Approx(1.0));
    CHECK(moment / light == doctest::Approx(-3.0 + 0.5 + frame).epsilon(1e-6));
  }
}

TEST_CASE("frames, seeds, codes and the noise-free signal") {
  const CopiedBoard board;
  const auto three = simulated(board, {"--frames", "3", "--seed", "4"});
  CHECK(three.has_frame_axis);
  CHECK(three.frames == 3);
  CHECK(three.values == simulated(board, {"--frames", "3", "--seed", "4"}).values);
  CHECK(three.values != simulated(board, {"--frames", "3", "--seed", "5"}).values);

  const auto exact = simulated(board, {"--noise-free"});
  const auto codes = simulated(board, {"--codes", "--noise-free"});
  const double lsb = 128.0 / 65536.0, dark = 64.0;
  for (std::size_t m = 0; m < exact.values.size(); ++m) {
    CHECK(codes.values[m] == std::round(codes.values[m]));
    CHECK(std::abs((codes.values[m] - dark) * lsb - exact.values[m]) <= 0.51 * lsb);
  }
}

TEST_CASE("the noise-free signal keeps what the eye as built makes of it in every frame") {
  const CopiedBoard board;
  const auto drawn = simulated(board, {"--noise-free"});
  board.change("[sensor]", "[build]\noffset_spread_lsb = 30\ndust_share = 0.2\n[sensor]");
  const auto built = simulated(board, {"--noise-free", "--frames", "2", "--seed", "4"});
  CHECK(built.values == simulated(board, {"--noise-free", "--frames", "2", "--seed", "5"}).values);
  double squares = 0.0;
  for (std::size_t m = 0; m < 64; ++m) {
    CHECK(built.values[m] == built.values[64 + m]);
    squares += std::pow((built.values[m] - drawn.values[m]) * 65536.0 / 128.0, 2);
  }
  CHECK(std::sqrt(squares / 64.0) > 20.0);
}

TEST_CASE("channels that tell nothing are NaN with weight zero") {
  const CopiedBoard board;
  board.change("dead = []", "dead = [7]");
  const auto weights_file = board.outside("w.npy");
  const auto samples = simulated(board, {"--weights", weights_file.string()});
  const auto weights = firmware::read_samples(weights_file, 64);
  REQUIRE(weights.has_value());
  for (std::size_t m = 0; m < samples.values.size(); ++m) {
    CHECK(std::isnan(samples.values[m]) == (m == 7));
    CHECK(weights->values[m] == (m == 7 ? 0.0 : 1.0));
  }
}

TEST_CASE("--explain says which effects are on and off and why, and --json the same in one object") {
  const CopiedBoard board;
  const Ended text = test::compueye({"simulate", "--board", board.path().string(), "--explain", "--noise-free"});
  CHECK(text.exit_code == 0);
  CHECK(contains(text.out, "read_noise"));
  CHECK(contains(text.out, "off, as asked"));
  const Ended json = test::compueye({"simulate", "--board", board.path().string(), "--explain", "--json"});
  const auto object = nlohmann::json::parse(json.out, nullptr, false);
  REQUIRE_FALSE(object.is_discarded());
  REQUIRE(object["effects"].size() == sim::effects().size());
  for (std::size_t k = 0; k < sim::effects().size(); ++k) {
    const auto& effect = object["effects"][k];
    CHECK(effect["name"] == sim::effects()[k]->name);
    const bool called = effect["name"] == "read_noise" || effect["name"] == "dark_level";
    CHECK(effect["on"] == called);
    CHECK(effect["decision"] == (called ? "on" : "not called for"));
    CHECK(effect["called_for_by"].get<std::string>().empty() == !called);
    CHECK((effect["bound_lsb"] > 0.0) == called);
  }
  CHECK(object["left_out_nmse"] == 0.0);
}

TEST_CASE("what noise would hide is left out, unless there is none") {
  const CopiedBoard board;
  board.change("dark_level_lsb = 64", "dark_level_lsb = 64\ninl_lsb = 0.1");
  const auto explained = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"simulate", "--board", board.path().string(), "--explain", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return nlohmann::json::parse(test::compueye(arguments).out);
  };
  const auto on = [](const nlohmann::json& object) {
    for (const auto& effect : object["effects"]) {
      if (effect["name"] == "nonlinearity") return effect["on"].get<bool>();
    }
    return false;
  };
  const auto noisy = explained({}), exact = explained({"--noise-free"}), coded = explained({"--noise-free", "--codes"});
  CHECK_FALSE(on(noisy));
  CHECK(noisy["left_out_nmse"].get<double>() > 0.0);
  CHECK(on(exact));
  CHECK(exact["noise_lsb"] == 0.0);
  CHECK(exact["left_out_nmse"] == 0.0);
  CHECK(coded["noise_lsb"].get<double>() == doctest::Approx(std::sqrt(1.0 / 12.0)));
  const Ended text = test::compueye({"simulate", "--board", board.path().string(), "--explain", "--noise-free"});
  CHECK(contains(text.out, "There is no noise"));
}

TEST_CASE("how much a reconstruction bears is measured once for a scene") {
  const CopiedBoard board;
  board.change("dark_level_lsb = 64", "dark_level_lsb = 64\ninl_lsb = 0.1");
  const auto kept = [&] {
    std::vector<std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(board.cache())) {
      const std::string name = entry.path().filename().string();
      if (name.starts_with("sensitivity-")) files.push_back(name + bytes_of(entry.path()));
    }
    std::sort(files.begin(), files.end());
    return files;
  };
  const std::vector<std::string> arguments{"simulate", "--board", board.path().string(), "--explain", "--json"};
  const Ended first = test::compueye(arguments);
  CHECK(nlohmann::json::parse(first.out)["sensitivity_measured"] == true);
  const auto files = kept();
  REQUIRE(files.size() == 1);
  CHECK(test::compueye(arguments).out == first.out);
  CHECK(kept() == files);
  // A lambda of 0 by hand is another solver than one by the rule.
  board.change("iterations = 200", "iterations = 200\nlambda = 0");
  CHECK(test::compueye(arguments).exit_code == 0);
  CHECK(kept().size() == 2);
}

TEST_CASE("a white picture bears no more than another because it stands at the end of the box") {
  const CopiedBoard board;
  board.change("dark_level_lsb = 64", "dark_level_lsb = 64\ninl_lsb = 0.1");
  const auto noise_nmse = [&] {
    const Ended ended =
        test::compueye({"simulate", "--board", board.path().string(), "--scene", "white", "--explain", "--json"});
    const auto object = nlohmann::json::parse(ended.out);
    CHECK(object["sensitivity_measured"] == true);
    return object["noise_nmse"].get<double>();
  };
  const double at_the_end = noise_nmse();
  board.change("box = [0, 1]", "box = [0, 2]");
  CHECK(at_the_end / noise_nmse() == doctest::Approx(1.0).epsilon(0.1));
}

TEST_CASE("--png shows the samples where their ommatidia are, the largest white") {
  const CopiedBoard board;
  const auto png = board.outside("y.png");
  const auto samples = simulated(board, {"--noise-free", "--png", png.string()});
  const hal::Image picture = firmware::read_png(png.string()).value();
  CHECK(picture.rows == 160);
  CHECK(picture.cols == 160);
  const auto largest = static_cast<double>(*std::max_element(samples.values.begin(), samples.values.end()));
  for (int i = 0; i < 8; ++i) {
    for (int k = 0; k < 8; ++k) {
      const double wanted = static_cast<double>(samples.values[static_cast<std::size_t>(8 * i + k)]) / largest;
      CHECK(std::fabs(static_cast<double>(picture.at(20 * i + 3, 20 * k + 17)) - wanted) <= 0.5 / 255.0 + 1e-6);
    }
  }
}

TEST_CASE("wrong usage of simulate is refused") {
  const CopiedBoard board;
  const std::string path = board.path().string();
  CHECK(compueye::test::compueye({"simulate", "--board", path}).exit_code == 2);
  CHECK(compueye::test::compueye({"simulate", "--board", path, "--out", "y.npy", "--frames", "0"}).exit_code == 2);
  CHECK(compueye::test::compueye({"simulate", "--board", path, "--out", "y.npy", "--distance", "nan"}).exit_code == 2);
  const auto blocked = board.path() / "board.toml" / "y.npy";
  CHECK(compueye::test::compueye({"simulate", "--board", path, "--out", blocked.string()}).exit_code == 1);
}
