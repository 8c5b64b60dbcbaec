// What four frames tell of an eye, against eyes that are turned, dimmed and dirtied exactly.

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "calib/check/eye_change.hpp"
#include "calib/check/telling_patterns.hpp"
#include "calib/check/turn_slopes.hpp"
#include "calib/cone_section.hpp"
#include "calib/nominal.hpp"
#include "calib/patterns/pattern_family.hpp"
#include "calib/pixel_coverage.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/sanitized.hpp"

using namespace compueye;
using namespace compueye::calib;

namespace {

constexpr double degree = std::numbers::pi / 180.0;

hal::EyeGeometry checked_eye() {
  hal::EyeGeometry eye;
  eye.interommatidial_rad = 2.0 * degree;
  eye.acceptance_rad = 8.0 * degree;
  return eye;
}

hal::Vec3 turned(const hal::Vec3& v, std::size_t axis, double by) {
  const double c = std::cos(by), s = std::sin(by);
  if (axis == 0) return {v.x, c * v.y - s * v.z, s * v.y + c * v.z};
  if (axis == 1) return {c * v.x + s * v.z, v.y, c * v.z - s * v.x};
  return {c * v.x - s * v.y, s * v.x + c * v.y, v.z};
}

/// The rows of the eye turned about the centre of its dome: apexes, axes and all.
std::vector<double> signals_turned(const hal::EyeGeometry& eye, const hal::ObjectPlane& plane,
                                   const hal::Image& picture, std::size_t axis, double by) {
  std::vector<double> y;
  for (int m = 0; m < eye.ommatidia(); ++m) {
    const int i = m / eye.columns, k = m % eye.columns;
    const ConeSection section(turned(eye.apex(i, k), axis, by), turned(eye.axis(i, k), axis, by),
                              0.5 * eye.acceptance_rad, plane.z_mm(eye));
    double sum = 0.0;
    for (int n = 0; n < plane.pixels(); ++n) {
      const double left = (n % plane.cols) * plane.pixel_width_mm() - 0.5 * plane.width_mm - section.vertex_x_mm();
      const double top = 0.5 * plane.height_mm - (n / plane.cols) * plane.pixel_height_mm() - section.vertex_y_mm();
      const Cell cell{left, left + plane.pixel_width_mm(), top - plane.pixel_height_mm(), top};
      sum += coverage(section, cell) * static_cast<double>(picture.pixels[static_cast<std::size_t>(n)]);
    }
    y.push_back(sum);
  }
  return y;
}

/// An eye, the four pictures of a check, and what it gives of them.
struct CheckBench {
  hal::EyeGeometry eye = checked_eye();
  hal::ObjectPlane plane;
  recon::Response rows = nominal_response(eye, plane).value();
  std::vector<hal::Image> pictures;
  CheckSamples samples;
  static constexpr double noise = 0.02;  ///< of a frame, in white pixels; white gives about 12

  CheckBench() {
    std::vector<hal::Image> patterns;
    const PatternFamily& blobs = *pattern_family("blobs").value();
    for (int p = 0; p < 24; ++p) patterns.push_back(blobs.draw(plane.rows, plane.cols, 1, p).value());
    pictures = {hal::Image(plane.rows, plane.cols, 1.0F)};
    for (const std::size_t p : telling_patterns(rows, eye, plane, patterns, 3)) pictures.push_back(patterns[p]);
    samples.channels = eye.ommatidia();
    samples.judged.assign(static_cast<std::size_t>(samples.channels), 1);
    for (const hal::Image& picture : pictures) {
      const std::vector<double> y = signals_turned(eye, plane, picture, 0, 0.0);
      samples.then.insert(samples.then.end(), y.begin(), y.end());
      const auto slopes = turn_slopes(rows, eye, plane, picture);
      samples.by_turn.insert(samples.by_turn.end(), slopes.begin(), slopes.end());
    }
    samples.then_variance.assign(samples.then.size(), noise * noise);
    samples.now_variance = samples.then_variance;
    samples.dark_then.assign(64, 0.5);
    samples.dark_variance.assign(64, noise * noise / 4.0);
  }

  /// Both looks with noise, the second at `y`.
  [[nodiscard]] EyeChange judged(const std::vector<double>& y, std::mt19937_64& random) const {
    std::normal_distribution<double> normal(0.0, noise);
    CheckSamples drawn = samples;
    drawn.now = y;
    std::normal_distribution<double> dark_noise(0.0, noise / 2.0);
    if (drawn.dark_now.empty()) drawn.dark_now = drawn.dark_then;
    for (double& value : drawn.dark_now) value += dark_noise(random);
    for (double& value : drawn.then) value += normal(random);
    for (double& value : drawn.now) value += normal(random);
    return eye_change(drawn).value();
  }
  [[nodiscard]] std::vector<double> all_turned(std::size_t axis, double by) const {
    std::vector<double> all;
    for (const hal::Image& picture : pictures) {
      const std::vector<double> y = signals_turned(eye, plane, picture, axis, by);
      all.insert(all.end(), y.begin(), y.end());
    }
    return all;
  }
};

}  // namespace

TEST_CASE("the slopes of a turn are those of an eye that is turned, apexes and all") {
  const CheckBench bench;
  for (std::size_t axis = 0; axis < turn_axes; ++axis) {
    constexpr double by = 0.02 * degree;
    const std::vector<double> more = bench.all_turned(axis, by), less = bench.all_turned(axis, -by);
    double difference = 0.0, size = 0.0;
    for (std::size_t at = 0; at < more.size(); ++at) {
      const double slope = (more[at] - less[at]) / (2.0 * by);
      difference += (slope - bench.samples.by_turn[at][axis]) * (slope - bench.samples.by_turn[at][axis]);
      size += slope * slope;
    }
    CAPTURE(axis);
    CHECK(std::sqrt(difference / size) < 0.3);  // hard edges of cone, pixel and display
    CHECK(size > 0.0);
  }
}

TEST_CASE("an eye that nothing happened to raises no more false alarms than one in a thousand") {
  const CheckBench bench;
  std::mt19937_64 random(7);
  const int checks = test::sanitized ? 200 : 20000;
  int alarms = 0;
  for (int k = 0; k < checks; ++k) alarms += bench.judged(bench.samples.then, random).changed() ? 1 : 0;
  CHECK(alarms <= checks / 1000 + (test::sanitized ? 2 : 0));
  if (!test::sanitized) CHECK(alarms >= 2);  // else the question is not asked sharply
}

TEST_CASE("four frames tell a gain, a turn and one ommatidium, each as what it is") {
  const CheckBench bench;
  std::mt19937_64 random(11);
  constexpr int draws = 100;
  int gains = 0, turns = 0, singles = 0;
  std::vector<double> dimmed = bench.samples.then, dirtied = dimmed;
  for (double& value : dimmed) value *= 0.998;
  for (std::size_t at = 27; at < dirtied.size(); at += 64) dirtied[at] *= 0.95;
  for (int k = 0; k < draws; ++k) {
    const EyeChange gain = bench.judged(dimmed, random);
    gains += gain.gain_changed && !gain.turned && gain.channels.empty() && !gain.rest_changed ? 1 : 0;
    CHECK(gain.gain.value == doctest::Approx(-0.002).epsilon(5.0 * gain.gain.sigma / 0.002));
    const std::size_t axis = static_cast<std::size_t>(k) % turn_axes;
    const EyeChange turn = bench.judged(bench.all_turned(axis, 0.05 * degree), random);
    turns += turn.turned && !turn.gain_changed && turn.channels.empty() ? 1 : 0;
    CHECK(turn.turn_rad[axis] == doctest::Approx(0.05 * degree).epsilon(0.25));
    const EyeChange single = bench.judged(dirtied, random);
    singles += single.channels.size() == 1 && single.channels.front().channel == 27 && !single.gain_changed ? 1 : 0;
    if (!single.channels.empty()) CHECK(single.channels.front().change.value == doctest::Approx(-0.05).epsilon(0.2));
  }
  CHECK(gains >= 98);
  CHECK(turns >= 98);
  CHECK(singles >= 98);
}

TEST_CASE("more noise is told as noise, and as no gain, turn or ommatidium") {
  CheckBench bench;
  std::mt19937_64 random(23);
  std::normal_distribution<double> more(0.0, 4.0 * CheckBench::noise);
  int noisy = 0, wrong = 0;
  constexpr int draws = 200;
  for (int k = 0; k < draws; ++k) {
    std::vector<double> y = bench.samples.then;
    for (double& value : y) value += more(random);
    const EyeChange change = bench.judged(y, random);
    noisy += (change.noisier || change.rest_changed) && change.noise_ratio > 2.0 && change.noise_ratio < 4.0 ? 1 : 0;
    wrong += change.gain_changed || change.turned || !change.channels.empty() ? 1 : 0;
  }
  CHECK(noisy == draws);
  CHECK(wrong <= 2);
}

TEST_CASE("a restless light hides a small gain, and is no alarm; dark, masked and missing samples tell nothing") {
  CheckBench bench;
  std::mt19937_64 random(13);
  bench.samples.light_spread = 0.01;
  std::vector<double> dimmed = bench.samples.then;
  for (double& value : dimmed) value *= 1.01;
  const EyeChange restless = bench.judged(dimmed, random);
  CHECK_FALSE(restless.changed());
  CHECK(restless.gain.sigma > 0.01);

  bench.samples.judged[5] = 0;
  dimmed[5] = 1e6;
  dimmed[6] = std::numeric_limits<double>::quiet_NaN();
  bench.samples.then[7] = bench.samples.then[71] = bench.samples.then[135] = bench.samples.then[199] = 0.0;
  const EyeChange untold = bench.judged(dimmed, random);
  CAPTURE(untold.channels.size());
  CAPTURE(untold.dark.value);
  CAPTURE(untold.dark_channels.size());
  CAPTURE(untold.turned);
  CAPTURE(untold.rest_chi2);
  CHECK_FALSE(untold.changed());
}

TEST_CASE("dark levels that went, all or one, are told as what they are") {
  CheckBench bench;
  std::mt19937_64 random(19);
  bench.samples.dark_now.assign(64, 0.5 + 0.6);
  const EyeChange all = bench.judged(bench.samples.then, random);
  CHECK(all.dark_changed);
  CHECK(all.dark.value * bench.samples.then[27] == doctest::Approx(0.6).epsilon(0.3));
  CHECK(all.dark_channels.empty());
  CHECK_FALSE(all.gain_changed);
  bench.samples.dark_now.assign(64, 0.5);
  bench.samples.dark_now[20] = 1.0;
  const EyeChange one = bench.judged(bench.samples.then, random);
  CHECK_FALSE(one.dark_changed);
  REQUIRE(one.dark_channels.size() == 1);
  CHECK(one.dark_channels.front().channel == 20);
  bench.samples.dark_now.assign(64, 0.5 + 0.6);
  bench.samples.dark_spread = 0.6;  // as in the session
  CHECK_FALSE(bench.judged(bench.samples.then, random).changed());
}

TEST_CASE("several things at once are told apart") {
  const CheckBench bench;
  std::mt19937_64 random(17);
  std::vector<double> y = bench.all_turned(1, -0.1 * degree);
  for (std::size_t at = 0; at < y.size(); ++at) y[at] *= at % 64 == 9 ? 0.5 : at % 64 == 40 ? 1.1 * 1.01 : 1.01;
  const EyeChange change = bench.judged(y, random);
  CHECK(change.gain_changed);
  CHECK(change.gain.value == doctest::Approx(0.01).epsilon(0.2));
  CHECK(change.turned);
  CHECK(change.turn_rad[1] == doctest::Approx(-0.1 * degree).epsilon(0.2));
  REQUIRE(change.channels.size() >= 2);
  CHECK(std::ranges::find(change.channels, 9, &ChangedChannel::channel) != change.channels.end());
  CHECK(std::ranges::find(change.channels, 40, &ChangedChannel::channel) != change.channels.end());
}

TEST_CASE("samples that do not belong together are refused") {
  CheckBench bench;
  bench.samples.dark_now = bench.samples.dark_then;
  bench.samples.now = bench.samples.then;
  bench.samples.now.pop_back();
  test::check_error(eye_change(bench.samples), hal::ErrorCode::mismatch, "check", {});
  bench.samples.now = bench.samples.then;
  bench.samples.light_spread = -1.0;
  test::check_error(eye_change(bench.samples), hal::ErrorCode::out_of_range, "check", {"-1"});
  bench.samples.light_spread = 0.0;
  std::fill(bench.samples.judged.begin(), bench.samples.judged.end() - 3, std::uint8_t{0});
  test::check_error(eye_change(bench.samples), hal::ErrorCode::usage, "check", {"3", "4"});
}
