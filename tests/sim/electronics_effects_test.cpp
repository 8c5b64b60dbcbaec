#include <doctest/doctest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "sim/random/random.hpp"
#include "tests/sanitized.hpp"
#include "tests/sim/effect_rig.hpp"

using namespace compueye;
using test::EffectRig;
using test::moments;

TEST_CASE("read noise draws what it always drew") {
  EffectRig rig(50, 50, 0.0);
  CHECK(rig.called("read_noise").empty());
  rig.board.sensor.read_noise_lsb = 2.0;
  const std::vector<double> levels = rig.play({"read_noise"}, 3, 9)[2];
  for (std::size_t m = 0; m < levels.size(); m += 99) {
    sim::RandomStream random({9, sim::Draws::read_noise, 2, static_cast<std::uint32_t>(m)});
    CHECK(levels[m] == 2.0 * random.gaussian());
  }
  CHECK(std::fabs(std::sqrt(moments(levels).variance) / 2.0 - 1.0) < 4.0 / std::sqrt(5000.0));
  CHECK(rig.bound("read_noise") == 2.0);
}

TEST_CASE("the multiplexer keeps a share of the channel before, along a converter and not into the next") {
  EffectRig rig(1, 8, 0.0);
  CHECK(rig.called("mux_memory").empty());
  rig.board.detector.mux_channels = 4;
  rig.board.detector.mux_slot_us = 3.0;
  rig.board.detector.mux_time_constant_us = 3.0 / std::log(10.0);  // a tenth is left
  std::vector<double> levels(8, 0.0);
  levels[1] = 1000.0;
  levels[3] = 500.0;
  rig.look_at(levels);
  // An RC charged from the channel before, by hand.
  const std::vector<double> expected{0.0, 900.0, 90.0, 459.0, 0.0, 0.0, 0.0, 0.0};
  const auto played = rig.played({"mux_memory"});
  for (std::size_t m = 0; m < 8; ++m) CHECK(played[m] == doctest::Approx(expected[m]));
  const double truth = rig.change({"mux_memory"});
  CHECK(rig.bound("mux_memory") >= truth);
  CHECK(rig.bound("mux_memory") <= 10.0 * truth);
}

TEST_CASE("the bound of the multiplexer's memory knows of hot channels, gains, photons and light that flickers") {
  EffectRig rig;
  rig.board.detector.mux_channels = 8;
  rig.board.detector.mux_slot_us = 3.0;
  rig.board.detector.mux_time_constant_us = 3.0 / std::log(10.0);
  CHECK(rig.bound("mux_memory") == 0.0);  // as bright for all
  const auto check_with = [&](const std::vector<std::string_view>& before, int frames = 1) {
    std::vector<std::string_view> all = before;
    all.emplace_back("mux_memory");
    const auto with = rig.play(all, frames), without = rig.play(before, frames);
    double squares = 0.0;
    for (std::size_t f = 0; f < with.size(); ++f) {
      for (std::size_t m = 0; m < 64; ++m) squares += std::pow(with[f][m] - without[f][m], 2);
    }
    const double truth = std::sqrt(squares / 64.0 / frames);
    CAPTURE(before.front());
    CHECK(truth > 0.5);
    CHECK(rig.bound("mux_memory") >= truth);
    CHECK(rig.bound("mux_memory") <= 10.0 * truth);
    return truth;
  };
  rig.board.detector.hot = {20};
  rig.board.detector.hot_lsb = 4000.0;
  CHECK(check_with({"defects"}) > 50.0);
  const double without_stuck = rig.bound("mux_memory");
  rig.board.detector.stuck = {7, 33, 41};  // their codes, whatever they are, never come by
  CHECK(rig.bound("mux_memory") == without_stuck);
  rig.board.detector.stuck.clear();
  rig.board.detector.hot.clear();
  rig.board.build.gain_spread = 0.05;
  check_with({"gain_spread"});
  rig.board.build.gain_spread = 0.0;
  rig.board.detector.electrons_per_lsb = 1.0;
  check_with({"shot_noise"}, 20);
  rig.board.detector.electrons_per_lsb = 0.0;
  std::vector<double> steps(64, 0.0);
  for (std::size_t m = 0; m < 64; m += 2) steps[m] = 1000.0;
  rig.look_at(steps);
  rig.board.detector.integration_ms = 1.0;
  rig.scene.light.mains_hz = 50.0;
  rig.scene.light.flicker_depth = 0.9;
  check_with({"mains_flicker"}, 7);
}

TEST_CASE("interleaved channels keep a share of the one that their converter read before, not of their neighbour") {
  EffectRig rig(1, 8, 0.0);
  rig.board.detector.mux_channels = 4;
  rig.board.detector.mux_order = hal::MuxOrder::interleaved;  // one converter has the even channels, one the odd
  rig.board.detector.mux_slot_us = 3.0;
  rig.board.detector.mux_time_constant_us = 3.0 / std::log(10.0);
  std::vector<double> levels(8, 0.0);
  levels[1] = 1000.0;
  levels[4] = 500.0;
  rig.look_at(levels);
  const std::vector<double> expected{0.0, 1000.0, 0.0, 100.0, 450.0, 10.0, 45.0, 1.0};
  const auto played = rig.played({"mux_memory"});
  for (std::size_t m = 0; m < 8; ++m) CHECK(played[m] == doctest::Approx(expected[m]));
  CHECK(rig.bound("mux_memory") >= rig.change({"mux_memory"}));
  CHECK(rig.bound("mux_memory") <= 10.0 * rig.change({"mux_memory"}));
  // Levels that repeat along a converter leave nothing to remember, however steep they are between neighbours.
  rig.look_at({0.0, 1000.0, 0.0, 1000.0, 0.0, 1000.0, 0.0, 1000.0});
  CHECK(rig.change({"mux_memory"}) == 0.0);
  CHECK(rig.bound("mux_memory") == 0.0);
}

TEST_CASE("the converter bows by its INL in mid-scale and not at its ends") {
  EffectRig rig(1, 5);
  CHECK(rig.called("nonlinearity").empty());
  rig.board.sensor.bits = 12;
  rig.board.detector.inl_lsb = 6.0;
  rig.look_at({0.0, 1024.0, 2048.0, 4096.0, 9000.0});
  const auto played = rig.played({"nonlinearity"});
  const std::vector<double> expected{0.0, 1028.5, 2054.0, 4096.0, 9000.0};
  for (std::size_t m = 0; m < 5; ++m) CHECK(played[m] == doctest::Approx(expected[m]));
  CHECK(rig.bound("nonlinearity") >= rig.change({"nonlinearity"}));
  CHECK(rig.bound("nonlinearity") <= 2.0 * rig.change({"nonlinearity"}));
  rig.board.sensor.dark_level_lsb = 100.0;
  CHECK(rig.bound("nonlinearity") >= rig.change({"dark_level", "nonlinearity"}) - 100.0);
}

TEST_CASE("1/f noise has its rms over 1000 frames about their mean, and that of all time within its bound") {
  EffectRig rig(10, 10, 0.0);
  CHECK(rig.called("flicker_noise").empty());
  rig.board.detector.flicker_noise_lsb = 2.0;
  const int windows = test::sanitized ? 3 : 30;
  const auto frames = rig.play({"flicker_noise"}, 1000 * windows);
  double within = 0.0;
  for (std::size_t m = 0; m < 100; ++m) {
    for (int w = 0; w < windows; ++w) {
      std::vector<double> window;
      for (std::size_t f = 0; f < 1000; ++f) window.push_back(frames[static_cast<std::size_t>(w) * 1000 + f][m]);
      within += moments(window).variance / windows / 100.0;
    }
  }
  CHECK(std::sqrt(within) == doctest::Approx(2.0).epsilon(test::sanitized ? 0.08 : 0.03));
  double all = 0.0;
  for (const auto& levels : frames) {
    for (const double level : levels) all += level * level / static_cast<double>(frames.size()) / 100.0;
  }
  CHECK(rig.bound("flicker_noise") >= std::sqrt(all));
  CHECK(rig.bound("flicker_noise") <= 2.0 * std::sqrt(all));
}

TEST_CASE("the power of 1/f noise falls as 1/f") {
  EffectRig rig(16, 16, 0.0);
  rig.board.detector.flicker_noise_lsb = 1.0;
  constexpr int n = 2048;
  const auto frames = rig.play({"flicker_noise"}, n);
  // Periodogram by the sum itself, averaged over the channels and over half an octave about each frequency; Hann's
  // window, because power beyond the window leaks otherwise.
  const auto power = [&](int cycles) {
    double sum = 0.0;
    int terms = 0;
    for (std::size_t m = 0; m < 256; m += test::sanitized ? 16 : 2) {
      for (int k = cycles; k < cycles + std::max(1, cycles / 4); k += std::max(1, cycles / 16)) {
        std::complex<double> amplitude;
        for (int f = 0; f < n; ++f) {
          const double phase = 2.0 * std::numbers::pi * k * f / n;
          const double window = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * f / n);
          amplitude += window * frames[static_cast<std::size_t>(f)][m] * std::polar(1.0, -phase);
        }
        sum += std::norm(amplitude);
        ++terms;
      }
    }
    return sum / terms;
  };
  const double octaves = 6.0;
  const double slope = std::log2(power(512) / power(8)) / octaves;
  CHECK(slope == doctest::Approx(-1.0).epsilon(0.12));
}

TEST_CASE("1/f noise of a frame is the same whichever frames were asked for before") {
  EffectRig rig(3, 3, 0.0);
  rig.board.detector.flicker_noise_lsb = 1.0;
  const auto in_order = rig.play({"flicker_noise"}, 300);
  const sim::Workings w = rig.workings({"flicker_noise"});
  for (const int f : {250, 3, 299, 3, 0, 128}) {
    std::vector<double> levels(9, 0.0);
    std::vector<std::int32_t> stuck(9, -1);
    sim::FrameInWork frame{static_cast<std::uint64_t>(f), 0.0, levels, stuck};
    w.steps[0]->apply(frame);
    CHECK(levels == in_order[static_cast<std::size_t>(f)]);
  }
}
