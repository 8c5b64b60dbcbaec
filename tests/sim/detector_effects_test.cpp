#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/sim/effect_rig.hpp"

using namespace compueye;
using test::EffectRig;
using test::moments;

namespace {

/// All levels of all frames less `from`.
std::vector<double> pooled(const std::vector<std::vector<double>>& frames, double from = 0.0) {
  std::vector<double> all;
  for (const auto& levels : frames) {
    for (const double level : levels) all.push_back(level - from);
  }
  return all;
}

void check_bound(const EffectRig& rig, std::string_view name, double truth) {
  CAPTURE(name);
  CAPTURE(truth);
  REQUIRE_FALSE(rig.called(name).empty());
  CHECK(rig.bound(name) >= truth);
  CHECK(rig.bound(name) <= 10.0 * truth);
}

}  // namespace

TEST_CASE("gains spread as told, a channel the same in every frame, and another build's otherwise") {
  EffectRig rig(50, 50, 1000.0);
  CHECK(rig.called("gain_spread").empty());
  rig.board.build.gain_spread = 0.02;
  const auto frames = rig.play({"gain_spread"}, 2);
  CHECK(frames[0] == frames[1]);
  const auto [mean, variance] = moments(frames[0]);
  // 2500 draws: the mean within 4 standard errors, the deviation within 4/sqrt(2 n).
  CHECK(std::fabs(mean - 1000.0) < 4.0 * 20.0 / 50.0);
  CHECK(std::fabs(std::sqrt(variance) / 20.0 - 1.0) < 4.0 / std::sqrt(5000.0));
  check_bound(rig, "gain_spread", rig.change({"gain_spread"}));
  rig.board.build.seed = 2;
  CHECK(rig.played({"gain_spread"}) != frames[0]);
}

TEST_CASE("offsets spread as told and do not depend on light") {
  EffectRig rig(50, 50, 1000.0);
  CHECK(rig.called("offset_spread").empty());
  rig.board.build.offset_spread_lsb = 3.0;
  const auto bright = rig.played({"offset_spread"});
  check_bound(rig, "offset_spread", rig.change({"offset_spread"}) * (1.0 - 1e-9));
  rig.look_at(std::vector<double>(2500, 0.0));
  const auto dark = rig.played({"offset_spread"});
  for (std::size_t m = 0; m < dark.size(); ++m) CHECK(bright[m] - dark[m] == doctest::Approx(1000.0));
  CHECK(std::fabs(std::sqrt(moments(dark).variance) / 3.0 - 1.0) < 4.0 / std::sqrt(5000.0));
}

TEST_CASE("the dark level is added and the bound is what is added") {
  EffectRig rig(2, 2, 10.0);
  CHECK(rig.called("dark_level").empty());
  rig.board.sensor.dark_level_lsb = 200.0;
  for (const double level : rig.played({"dark_level"})) CHECK(level == 210.0);
  CHECK(rig.bound("dark_level") == doctest::Approx(200.0));
}

TEST_CASE("dark current is charge over time and doubles every eight degrees") {
  EffectRig rig(2, 2, 0.0);
  CHECK(rig.called("dark_current").empty());
  rig.board.detector.electrons_per_lsb = 20.0;
  rig.board.detector.dark_current_e_per_s = 40000.0;
  // 40000 e/s for 10 ms at 20 e/LSB.
  CHECK(rig.played({"dark_current"})[0] == doctest::Approx(20.0));
  rig.board.detector.integration_ms = 5.0;
  CHECK(rig.played({"dark_current"})[0] == doctest::Approx(10.0));
  rig.board.detector.temperature_c = 41.0;
  CHECK(rig.played({"dark_current"})[0] == doctest::Approx(40.0));
  check_bound(rig, "dark_current", rig.change({"dark_current", "shot_noise"}, 400) * (1.0 - 0.01));
}

TEST_CASE("temperature drifts gains and dark current with the time, from what it is at the start") {
  EffectRig rig(2, 2, 1000.0);
  rig.board.frame_rate_hz = 1.0 / 45.0;  // 80 frames an hour
  rig.board.detector.warming_c_per_s = 0.1 / 45.0;
  CHECK(rig.called("temperature").empty());
  rig.board.detector.gain_per_c = 0.001;
  const auto frames = rig.play({"temperature"}, 81);
  CHECK(frames[0][0] == 1000.0);
  CHECK(frames[80][0] == doctest::Approx(1008.0));
  check_bound(rig, "temperature", rig.change({"temperature"}, 80));
  rig.board.detector.gain_per_c = 0.0;
  rig.board.detector.electrons_per_lsb = 10.0;
  rig.board.detector.dark_current_e_per_s = 50.0;
  // 5 LSB at 25 degrees, 10 LSB at 33.
  CHECK(rig.play({"temperature", "dark_current"}, 81)[80][0] == doctest::Approx(1010.0));
  check_bound(rig, "temperature", rig.change({"temperature"}, 80));
}

TEST_CASE("a sensor warms on while a scene begins anew") {
  EffectRig rig(2, 2, 1000.0);
  rig.scene.duration_s = 0.05;
  rig.board.frame_rate_hz = 0.01;
  rig.board.detector.warming_c_per_s = 0.02;
  rig.board.detector.gain_per_c = 0.001;
  check_bound(rig, "temperature", rig.change({"temperature"}, 36));
  rig.board.detector.gain_per_c = 0.01;
  rig.board.detector.electrons_per_lsb = 10.0;
  rig.board.detector.full_well_e = 14000.0;
  // Up to 1720 LSB; cut off beyond 1400, in the last .444 of the hour.
  check_bound(rig, "full_well", 320.0 * std::sqrt(0.444 / 3.0));
}

TEST_CASE("shot noise is Poisson's: variance is the mean over electrons per LSB, and levels are whole electrons") {
  EffectRig rig(30, 30, 5.0);
  CHECK(rig.called("shot_noise").empty());
  rig.board.detector.electrons_per_lsb = 3.0;
  for (const double level : {0.5, 5.0, 500.0}) {
    rig.look_at(std::vector<double>(900, level));
    const std::vector<double> all = pooled(rig.play({"shot_noise"}, 100));
    const auto [mean, variance] = moments(all);
    const double n = static_cast<double>(all.size()), expected = level / 3.0, electrons = 3.0 * level;
    CAPTURE(level);
    CHECK(std::fabs(mean - level) < 4.0 * std::sqrt(expected / n));
    // Kurtosis of Poisson: 3 + 1 / mean.
    CHECK(std::fabs(variance / expected - 1.0) < 4.0 * std::sqrt((2.0 + 1.0 / electrons) / n));
    for (const double each : all) REQUIRE(std::fabs(each * 3.0 - std::round(each * 3.0)) < 1e-9);
    check_bound(rig, "shot_noise", std::sqrt(variance));
  }
  rig.look_at(std::vector<double>(900, -2.0));
  for (const double level : rig.played({"shot_noise"})) CHECK(level == -2.0);
}

TEST_CASE("a well holds so many electrons and calls only where light comes near") {
  EffectRig rig(4, 4, 100.0);
  rig.board.detector.electrons_per_lsb = 10.0;
  CHECK(rig.called("full_well").empty());
  rig.board.detector.full_well_e = 3000.0;
  CHECK(rig.called("full_well").empty());
  std::vector<double> levels(16, 100.0);
  levels[5] = 450.0;
  rig.look_at(levels);
  const auto played = rig.played({"full_well"});
  CHECK(played[5] == 300.0);
  CHECK(played[4] == 100.0);
  check_bound(rig, "full_well", rig.change({"full_well"}));
}

TEST_CASE("hot channels are brighter, stuck ones tell one code, blinking ones are away half of the time") {
  EffectRig rig(4, 4, 100.0);
  rig.board.sensor.bits = 12;
  CHECK(rig.called("defects").empty());
  rig.board.detector.hot = {1};
  CHECK(rig.called("defects").empty());
  rig.board.detector.hot_lsb = 40.0;
  rig.board.detector.stuck = {2, 3};
  rig.board.detector.blinking = {7};
  constexpr int frames = 40000;
  const auto played = rig.play({"defects"}, frames);
  int away = 0, turns = 0;
  for (std::size_t f = 0; f < played.size(); ++f) {
    CHECK(played[f][0] == 100.0);
    CHECK(played[f][1] == 140.0);
    CHECK(played[f][2] == played[0][2]);
    away += played[f][7] == 0.0 ? 1 : 0;
    turns += f > 0 && played[f][7] != played[f - 1][7] ? 1 : 0;
  }
  CHECK(played[0][2] != played[0][3]);
  CHECK((played[0][2] >= 0.0 && played[0][2] <= 4095.0));
  // 400 throws of a coin: away in half of them, another in half of the steps.
  CHECK(std::fabs(away / 100.0 - 200.0) < 4.0 * 10.0);
  CHECK(std::abs(turns - 200) < 4 * 10);
  check_bound(rig, "defects", rig.change({"defects"}, 1000));
}
