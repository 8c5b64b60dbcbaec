#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "hal/clock.hpp"
#include "sim/render/drawn_signals.hpp"
#include "sim/simulated_display.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/hal/units.hpp"

using namespace compueye;

namespace {

using compueye::test::ms;

sim::SimulatedEyeSettings before_a_display() {
  sim::SimulatedEyeSettings settings;
  settings.board.eye.rows = settings.board.eye.columns = 4;
  settings.board.eye.interommatidial_rad = 0.03;
  settings.board.eye.acceptance_rad = 0.14;
  settings.board.object = {8, 8, 8.0, 8.0, 30.0};
  settings.board.sensor = {};
  settings.board.sensor.bits = 16;
  settings.board.sensor.full_scale = 128.0;
  settings.board.sensor.read_noise_lsb = 0.0;
  settings.board.frame_rate_hz = settings.frame_rate_hz = 1000.0;
  settings.fifo_frames = 1;
  settings.scenes = {sim::scene_on(settings.board.object, "display", hal::Image(8, 8, 1.0F))};
  settings.scenes[0].surfaces[0].shines = true;
  return settings;
}

struct DisplayBench {
  hal::VirtualClock clock;
  sim::SimulatedEyeSettings settings;
  std::unique_ptr<sim::SimulatedEye> eye;
  sim::SimulatedDisplay display;

  explicit DisplayBench(sim::SimulatedEyeSettings wanted = before_a_display())
      : settings(wanted), eye(sim::SimulatedEye::create(wanted, clock).value()), display(*eye, clock) {
    REQUIRE(eye->start().has_value());
  }

  /// Of the next frame that is exposed `after_ns` from now.
  std::vector<double> levels(std::int64_t after_ns) {
    clock.advance(after_ns);
    for (const std::int64_t from_ns = clock.now_ns();;) {
      const auto block = eye->read(clock.now_ns() + 10 * ms).value();
      if (block.t_ns < from_ns) continue;
      std::vector<double> all;
      for (const std::int32_t code : block.codes) all.push_back(code - settings.board.sensor.dark_level_lsb);
      return all;
    }
  }

  [[nodiscard]] std::vector<double> expected(const hal::Image& picture) const {
    auto signals = sim::drawn_signals(settings.board.eye, settings.board.object,
                                      sim::scene_on(settings.board.object, "drawn", picture))
                       .value();
    for (double& signal : signals) signal /= settings.board.sensor.lsb();
    return signals;
  }
};

hal::Image chequers() {
  hal::Image picture(8, 8);
  for (int n = 0; n < 64; ++n) picture.pixels[static_cast<std::size_t>(n)] = (n / 8 + n) % 3 == 0 ? 1.0F : 0.0F;
  return picture;
}

double largest_level_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0.0;
  for (std::size_t m = 0; m < a.size(); ++m) most = std::max(most, std::fabs(a[m] - b[m]));
  return most;
}

}  // namespace

TEST_CASE("a display's picture is seen once it has settled, and nothing when its light is off") {
  DisplayBench bench;
  const hal::Image picture = chequers();
  REQUIRE(bench.display.show(picture.pixels).has_value());
  CHECK(largest_level_difference(bench.levels(100 * ms), bench.expected(picture)) <= 1.0);
  REQUIRE(bench.display.off().has_value());
  for (const double level : bench.levels(100 * ms)) CHECK(level == 0.0);
  const hal::Image white(8, 8, 1.0F);
  REQUIRE(bench.display.show(white.pixels).has_value());
  CHECK(largest_level_difference(bench.levels(100 * ms), bench.expected(white)) <= 1.0);
}

TEST_CASE("a picture comes exponentially with 4 ms, from whatever was there") {
  DisplayBench bench;
  const hal::Image white(8, 8, 1.0F), black(8, 8, 0.0F);
  REQUIRE(bench.display.show(white.pixels).has_value());
  const auto full = bench.levels(100 * ms);
  REQUIRE(bench.display.show(black.pixels).has_value());
  const std::int64_t changed_ns = bench.clock.now_ns();
  for (int k = 0; k < 12; ++k) {
    const auto block = bench.eye->read(bench.clock.now_ns() + 10 * ms).value();
    const double since_s = static_cast<double>(block.t_ns - changed_ns) * 1e-9;
    const double share = since_s < 0.0 ? 1.0 : std::exp(-since_s / 4e-3);
    const double level = block.codes[5] - bench.settings.board.sensor.dark_level_lsb;
    CHECK(level == doctest::Approx(share * full[5]).epsilon(1e-3));
  }
}

TEST_CASE("light that is on its way goes on from where it is") {
  DisplayBench bench;
  const hal::Image white(8, 8, 1.0F);
  REQUIRE(bench.display.show(white.pixels).has_value());
  const auto full = bench.levels(100 * ms);
  REQUIRE(bench.display.off().has_value());
  const auto away = bench.levels(6 * ms);  // exp(-1.5) and less
  CHECK(away[5] <= 0.25 * full[5]);
  CHECK(away[5] > 0.05 * full[5]);
  REQUIRE(bench.display.off().has_value());  // again: it is no darker and no brighter for that
  const auto block = bench.eye->read(bench.clock.now_ns() + 10 * ms).value();
  CHECK(block.codes[5] - bench.settings.board.sensor.dark_level_lsb <= away[5]);
}

TEST_CASE("what a display does to pictures is done to those that it is given: gamma, black level, drift") {
  auto settings = before_a_display();
  settings.scenes[0].display.gamma = 2.0;
  settings.scenes[0].display.black_level = 0.1;
  settings.scenes[0].display.drift_per_hour = 0.36;
  settings.scenes[0].effects = {{"display_response", sim::Forced::on}, {"display_drift", sim::Forced::on}};
  DisplayBench bench(settings);
  const hal::Image grey(8, 8, 128.0F / 255.0F), white(8, 8, 1.0F);
  REQUIRE(bench.display.show(white.pixels).has_value());
  const auto full = bench.levels(100 * ms);
  REQUIRE(bench.display.show(grey.pixels).has_value());
  const auto dim = bench.levels(100 * ms);
  const double share = 0.1 + 0.9 * std::pow(128.0 / 255.0, 2);
  for (std::size_t m = 0; m < full.size(); ++m) CHECK(dim[m] == doctest::Approx(share * full[m]).epsilon(2e-3));
  REQUIRE(bench.display.show(white.pixels).has_value());
  const auto later = bench.levels(100'000 * ms);  // 1 % in 100 s
  for (std::size_t m = 0; m < full.size(); ++m) CHECK(later[m] == doctest::Approx(1.01 * full[m]).epsilon(5e-4));
}

TEST_CASE("a picture of another size, or one that is none, is refused and changes nothing") {
  DisplayBench bench;
  const hal::Image white(8, 8, 1.0F), small(4, 4, 1.0F);
  REQUIRE(bench.display.show(white.pixels).has_value());
  test::check_error(bench.display.show(small.pixels), hal::ErrorCode::mismatch, "display", {"16", "64"});
  hal::Image bad(8, 8, 1.0F);
  bad.pixels[3] = std::nanf("");
  CHECK_FALSE(bench.eye->show(bad, 0.0).has_value());
  CHECK(largest_level_difference(bench.levels(100 * ms), bench.expected(white)) <= 1.0);
}
