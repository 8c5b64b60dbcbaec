#include "calib/estimate/light_samples.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "calib/row_draws.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye;
using calib::Captures;
using calib::ChannelStatus;
using calib::CodeNoise;

namespace {

constexpr std::size_t channels = 12, patterns = 64;
constexpr double dark = 50.0, white = 1000.0, noise_lsb = 1.0;

double lamp_at(double time) {
  return 1.0 + 0.02 * (time / 80.0 - 0.5);
}

/// Twelve channels that see all of a display of one pixel: each pattern is grey g, and channel m reads (m + 1) / 12 of
/// white.
Captures session() {
  Captures captures;
  calib::RowDraws draws(3, 4);
  double time = 0.0;
  const auto take = [&](double grey, std::vector<double>& into) {
    for (std::size_t m = 0; m < channels; ++m) {
      const double share = static_cast<double>(m + 1) / channels;
      into.push_back(dark + static_cast<double>(m) + share * white * grey * lamp_at(time) + noise_lsb * draws.normal());
    }
    return time++;
  };
  for (std::size_t p = 0; p <= patterns; ++p) {
    if (p % 16 == 0) captures.darks.time.push_back(take(0.0, captures.darks.codes));
    if (p % 8 == 0) captures.references.time.push_back(take(1.0, captures.references.codes));
    if (p == patterns) break;
    const float grey = static_cast<float>(draws.uniform());
    captures.patterns.push_back(grey);
    captures.time.push_back(take(static_cast<double>(grey), captures.codes));
    captures.held_out.push_back(p % 5 == 0 ? 1 : 0);
  }
  return captures;
}

CodeNoise noise() {
  CodeNoise noise;
  noise.read_noise_lsb = noise_lsb;
  noise.unit_lsb = 100.0;
  return noise;
}

calib::LightSamples made(const Captures& captures, const CodeNoise& of) {
  return calib::light_samples(captures, of, channels, 1, {});
}

}  // namespace

TEST_CASE("calib: dark levels and the lamp's drift are taken off") {
  const Captures captures = session();
  const calib::LightSamples samples = made(captures, noise());
  double squares = 0.0, drift = 0.0;
  for (std::size_t p = 0; p < patterns; ++p) {
    CHECK(samples.lamp[p] == doctest::Approx(lamp_at(captures.time[p])).epsilon(2e-3));
    drift = std::max(drift, std::abs(samples.lamp[p] - 1.0));
    for (std::size_t m = 0; m < channels; ++m) {
      const double truth = static_cast<double>(captures.patterns[p]) * 10.0 * static_cast<double>(m + 1) / channels;
      squares += (samples.at(p, m) - truth) * (samples.at(p, m) - truth) / samples.fixed_variance[p];
    }
  }
  CHECK(drift > 5e-3);
  // Dark levels are the mean of five frames, which adds a fifth; rounding was not simulated.
  CHECK(squares / (patterns * channels) == doctest::Approx(1.2).epsilon(0.25));
  for (const ChannelStatus status : samples.status) CHECK(status == ChannelStatus::good);
}

TEST_CASE("calib: shot noise adds to the variance what the light asks for") {
  CodeNoise shot = noise();
  shot.electrons_per_lsb = 4.0;
  const calib::LightSamples samples = made(session(), shot);
  // 1 unit = 100 LSB = 400 electrons: 20 of them are 5 LSB, .05 units.
  CHECK(samples.light_variance[0] == doctest::Approx(0.05 * 0.05).epsilon(0.02));
  CHECK(samples.fixed_variance[0] == doctest::Approx((1.0 + 1.0 / 12.0) * 1e-4).epsilon(0.03));
}

TEST_CASE("calib: bent converters are straightened before anything else") {
  Captures captures = session();
  const auto bent = [](double code) { return code + 20.0 * code / 1100.0 * (1.0 - code / 1100.0); };
  calib::LinearityTable table;
  for (double code = 0.0; code <= 1100.0; code += 10.0) {
    table.code.push_back(bent(code));
    table.straight.push_back(code);
  }
  const calib::LightSamples straight = made(captures, noise());
  for (auto* codes : {&captures.codes, &captures.darks.codes, &captures.references.codes}) {
    for (double& code : *codes) code = bent(code);
  }
  const calib::LightSamples before = made(captures, noise());
  captures.linearity.assign(channels, table);
  const calib::LightSamples after = made(captures, noise());
  double off_before = 0.0, off_after = 0.0;
  for (std::size_t at = 0; at < straight.light.size(); ++at) {
    off_before = std::max(off_before, std::abs(before.light[at] - straight.light[at]));
    off_after = std::max(off_after, std::abs(after.light[at] - straight.light[at]));
  }
  CHECK(off_before > 0.02);
  CHECK(off_after < 1e-3);
}

TEST_CASE("calib: hot, noisy and saturated channels are told apart, and lost samples are no samples") {
  Captures captures = session();
  calib::RowDraws draws(8, 8);
  CodeNoise limits = noise();
  limits.saturated_lsb = 1040.0;
  for (auto* codes : {&captures.codes, &captures.darks.codes, &captures.references.codes}) {
    for (std::size_t at = 0; at < codes->size(); ++at) {
      if (at % channels == 2) (*codes)[at] += 200.0;
      if (at % channels == 5) (*codes)[at] += 5.0 * draws.normal();
      if (at % channels == 9) (*codes)[at] = std::min((*codes)[at] * 2.0, 1045.0);
    }
  }
  captures.codes[7] = std::numeric_limits<double>::quiet_NaN();
  const calib::LightSamples samples = made(captures, limits);
  for (std::size_t m = 0; m < channels; ++m) {
    CAPTURE(m);
    CHECK(samples.status[m] == (m == 2   ? ChannelStatus::hot
                                : m == 5 ? ChannelStatus::noisy
                                : m == 9 ? ChannelStatus::saturated
                                         : ChannelStatus::good));
  }
  CHECK(std::isnan(samples.at(0, 7)));
  CHECK(std::isfinite(samples.at(1, 7)));
}

TEST_CASE("calib: a channel that blinks is noisy, and not taken for the lamp") {
  Captures blinking = session();
  for (std::size_t r = 0; r < blinking.references.count(); r += 3) blinking.references.codes[r * channels + 11] = dark;
  const auto plain = made(session(), noise()), with = made(blinking, noise());
  for (std::size_t m = 0; m < channels; ++m) {
    CAPTURE(m);
    CHECK(with.status[m] == (m == 11 ? ChannelStatus::noisy : ChannelStatus::good));
  }
  for (std::size_t p = 0; p < patterns; ++p) CHECK(with.lamp[p] == doctest::Approx(plain.lamp[p]).epsilon(2e-3));
}
