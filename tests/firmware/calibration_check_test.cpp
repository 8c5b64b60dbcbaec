// A calibrated eye is looked at again: as it was, and with what happens to eyes.

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "firmware/calibration/calibration_run.hpp"
#include "firmware/calibration/eye_check.hpp"
#include "firmware/calibration/simulated_bench.hpp"
#include "tests/firmware/calibrated_eye.hpp"
#include "tests/firmware/eye_in_a_scene.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/hal/units.hpp"

using namespace compueye;
using namespace compueye::firmware;

namespace {

using compueye::test::deg;

bool go_on(const calib::SessionProgress&) {
  return true;
}

const test::CalibratedEye& calibrated() {
  return test::CalibratedEye::once();
}

calib::EyeChange look(
    const sim::Scene& display, std::uint64_t seed,
    const std::function<double(std::size_t)>& factor = [](std::size_t) { return 1.0; }) {
  const EyeCheck check = calibrated().check();
  const Board& board = calibrated().board();
  const SimulatedBench bench = SimulatedBench::create(board, display, seed).value();
  test::EyeInAScene eye(*bench.eye, board.sensor.dark_level_lsb);
  eye.gain = [&](std::int64_t, std::size_t m) { return factor(m); };
  const auto captures =
      take_captures(check.plan(), check.schedule(), {eye, *bench.display, *bench.clock}, go_on).value();
  return check.judge(captures).value();
}

}  // namespace

TEST_CASE("an eye that is as it was is found so, whatever its noise") {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const calib::EyeChange change = look(plain_display(calibrated().board()), seed);
    CAPTURE(seed);
    CAPTURE(change.gain.chance);
    CAPTURE(change.turn_chance);
    CAPTURE(change.rest_chi2);
    CAPTURE(change.channels.size());
    CHECK_FALSE(change.changed());
  }
}

TEST_CASE("a light that is .2 % weaker, a dirty ommatidium and a turned eye are found, and told apart") {
  const sim::Scene display = plain_display(calibrated().board());
  const calib::EyeChange dimmed = look(display, 2, [](std::size_t) { return 0.998; });
  CHECK(dimmed.gain_changed);
  CHECK(dimmed.gain.value == doctest::Approx(-0.002).epsilon(0.3));
  CHECK_FALSE(dimmed.turned);
  CHECK(dimmed.channels.empty());

  const calib::EyeChange dirty = look(display, 3, [](std::size_t m) { return m == 27 ? 0.95 : 1.0; });
  CHECK_FALSE(dirty.gain_changed);
  REQUIRE(dirty.channels.size() == 1);
  CHECK(dirty.channels.front().channel == 27);
  CHECK(dirty.channels.front().change.value == doctest::Approx(-0.05).epsilon(0.1));

  // The eye shakes its head by .05 degrees: the display goes the other way, about the centre of the dome.
  sim::Scene turned = display;
  const double z = calibrated().board().object.z_mm(calibrated().board().eye);
  turned.surfaces.front().pose.centre_mm.x -= z * std::sin(0.05 * deg);
  const calib::EyeChange shaken = look(turned, 4);
  CHECK(shaken.turned);
  CHECK(shaken.turn_rad[1] == doctest::Approx(0.05 * deg).epsilon(0.3));
  CHECK(shaken.channels.size() <= 2);
}

TEST_CASE("a check needs a session at its distance, and its own captures") {
  test::check_error(EyeCheck::create(calibrated().file(), 50.0, 0.01, 64.0), hal::ErrorCode::not_found,
                    calibrated().file().path(), {"50"});
  test::check_error(calibrated().check().judge({}), hal::ErrorCode::mismatch, "check", {"0", "5"});
}
