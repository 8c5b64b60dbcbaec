#include "calib/estimate/estimate.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "calib/median.hpp"
#include "sim/random/random.hpp"
#include "sim/simulation.hpp"
#include "tests/calib/estimate/reconstruction.hpp"
#include "tests/calib/estimate/simulated_session.hpp"
#include "tests/calib/estimate/study_patterns.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/sanitized.hpp"

using namespace compueye;
using calib::ChannelStatus;
using calib::EstimateSettings;
using calib::ResponseEstimate;
using test::Session;
using test::SessionSettings;

namespace {

/// Under a sanitizer a corner of the eye does.
const sim::EyeToSimulate& board() {
  static const sim::EyeToSimulate eye = [] {
    sim::EyeToSimulate built = test::small_built_eye();
    if (test::sanitized) built.eye.rows = built.eye.columns = 3;
    return built;
  }();
  return eye;
}

const test::PixelResponses& eye() {
  static const test::PixelResponses responses = test::pixel_responses(board()).value();
  return responses;
}

Session session(std::vector<float> patterns, const SessionSettings& settings = {}) {
  auto made = test::simulated_session(board(), eye(), std::move(patterns), settings);
  REQUIRE(made.has_value());
  return *std::move(made);
}

Session blobs(int count, const SessionSettings& settings = {}) {
  return session(test::blob_patterns(16, 16, count, 77), settings);
}

ResponseEstimate estimated(const Session& from, const EstimateSettings& settings = {}) {
  auto found = calib::estimate_response(from.captures, from.noise, board().eye, board().object, settings);
  if (!found) MESSAGE(found.error().place << ": " << found.error().sentence);
  REQUIRE(found.has_value());
  return *std::move(found);
}

/// Of rows that are good.
std::vector<double> row_errors(const ResponseEstimate& estimate) {
  std::vector<double> errors;
  for (std::size_t m = 0; m < estimate.rows.size(); ++m) {
    const calib::RowEstimate& row = estimate.rows[m];
    if (row.status != ChannelStatus::good) continue;
    errors.push_back(test::relative_row_error(eye().row(static_cast<int>(m)), 256, row.columns, row.values));
  }
  return errors;
}

double median_error(const ResponseEstimate& estimate) {
  return calib::median(row_errors(estimate));
}

struct Coverage {
  double one = 0.0, two = 0.0;
};

/// Share of entries within one and two of their sigmas.
Coverage coverage(const ResponseEstimate& estimate) {
  Coverage within;
  double entries = 0.0;
  for (std::size_t m = 0; m < estimate.rows.size(); ++m) {
    const calib::RowEstimate& row = estimate.rows[m];
    for (std::size_t e = 0; e < row.columns.size(); ++e) {
      const double truth = eye().row(static_cast<int>(m))[row.columns[e]];
      const double off = std::abs(static_cast<double>(row.values[e]) - truth) / static_cast<double>(row.sigmas[e]);
      within.one += off < 1.0 ? 1.0 : 0.0;
      within.two += off < 2.0 ? 1.0 : 0.0;
      entries += 1.0;
    }
  }
  return {within.one / entries, within.two / entries};
}

}  // namespace

TEST_CASE("calib: rows found pixel by pixel are those of the simulated eye") {
  sim::EyeToSimulate exact = board();
  exact.sensor.bits = 20;
  exact.sensor.read_noise_lsb = exact.sensor.dark_level_lsb = exact.build.offset_spread_lsb = 0.0;
  std::vector<int> ommatidia;
  for (int m = 0; m < board().eye.ommatidia(); ++m) ommatidia.push_back(m);
  const auto alone = test::pixel_responses_of(board(), ommatidia);
  REQUIRE(alone.has_value());
  const std::vector<float> patterns = test::blob_patterns(16, 16, 3, 1);
  for (std::size_t p = 0; p < 3; ++p) {
    hal::Image picture(16, 16);
    std::copy_n(patterns.begin() + static_cast<std::ptrdiff_t>(p * 256), 256, picture.pixels.begin());
    auto direct = sim::Simulation::create(exact, sim::scene_on(board().object, "blobs", picture), 1,
                                          {.budget = {sim::PlanMode::everything}});
    REQUIRE(direct.has_value());
    const auto levels = direct->levels_lsb(0);
    for (std::size_t m = 0; m < levels.size(); ++m) {
      double sum = 0.0, finer = 0.0;
      for (std::size_t n = 0; n < 256; ++n) {
        sum += eye().row(static_cast<int>(m))[n] * static_cast<double>(picture.pixels[n]);
        finer += alone->row(static_cast<int>(m))[n] * static_cast<double>(picture.pixels[n]);
      }
      CHECK(sum == doctest::Approx(levels[m] * exact.sensor.lsb()).epsilon(1e-4));
      // Twelve shells or a hundred and twenty of them: the profile of issue 17 in either case.
      CHECK(finer == doctest::Approx(sum).epsilon(0.01));
    }
  }
}

TEST_CASE("calib: 256 patterns tell the rows of the built eye, and how well") {
  const ResponseEstimate hybrid = estimated(blobs(256));
  CHECK(median_error(hybrid) < 0.0085);
  for (const calib::RowEstimate& row : hybrid.rows) CHECK(row.status == ChannelStatus::good);
  if (test::sanitized) return;
  CHECK(median_error(hybrid) < 0.0055);  // as measured, .48 %
  const Coverage within = coverage(hybrid);
  CHECK(within.one > 0.60);
  CHECK(within.one < 0.75);
  CHECK(within.two > 0.92);
  CHECK(within.two < 0.98);
  EstimateSettings cones;
  cones.method = calib::RowMethod::parametric;
  const ResponseEstimate parametric = estimated(blobs(256), cones);
  CHECK(median_error(hybrid) < 0.6 * median_error(parametric));
  CHECK(median_error(parametric) < 0.02);
}

TEST_CASE("calib: errors by kind add up to what sigmas state, and gains are off by what is said") {
  const ResponseEstimate found = estimated(blobs(96));
  std::vector<double> off, said;
  for (std::size_t m = 0; m < found.rows.size(); ++m) {
    const calib::RowEstimate& row = found.rows[m];
    REQUIRE(row.errors.has_value());
    double norm = 0.0, stated = 0.0, along = 0.0, by_kind = 0.0;
    for (std::size_t e = 0; e < row.columns.size(); ++e) {
      const auto value = static_cast<double>(row.values[e]), sigma = static_cast<double>(row.sigmas[e]);
      norm += value * value;
      stated += sigma * sigma;
      along += value * (value - eye().row(static_cast<int>(m))[row.columns[e]]);
    }
    for (std::size_t k = 0; k < calib::row_error_kinds.size(); ++k) {
      by_kind += row.inflation * row.inflation * row.errors->now[k] * row.errors->now[k];
    }
    CHECK(by_kind == doctest::Approx(stated / norm).epsilon(1e-3));
    // What fields hide between their knots is in the rest, and no pattern takes it off.
    for (std::size_t k = 0; k < 3; ++k) {
      CHECK(row.errors->of_twice[k] < row.errors->now[k]);
      CHECK(row.errors->of_twice[k] > 0.6 * row.errors->now[k]);
    }
    off.push_back(std::abs(along / norm));
    said.push_back(row.inflation * row.errors->now[0]);
  }
  // Half of normal numbers are within .67 of their sigma; a few rows tell that roughly.
  CHECK(calib::median(off) < 2.0 * 0.67 * calib::median(said));
  CHECK(calib::median(off) > 0.3 * 0.67 * calib::median(said));
}

TEST_CASE("calib: the drift of the lamp costs little once references are counted in") {
  if (test::sanitized) return;
  SessionSettings drifting;
  drifting.drift = 0.01;
  CHECK(median_error(estimated(blobs(256, drifting))) < 0.013);
  const double with_references = median_error(estimated(blobs(256, drifting)));
  drifting.reference_every = 0;
  CHECK(with_references < 0.8 * median_error(estimated(blobs(256, drifting))));
}

TEST_CASE("calib: shot noise is borne") {
  if (test::sanitized) return;
  SessionSettings shot;
  shot.shot = true;
  const ResponseEstimate found = estimated(blobs(256, shot));
  CHECK(median_error(found) < 0.02);
  const Coverage within = coverage(found);
  CHECK(within.one > 0.60);
  CHECK(within.one < 0.75);
  CHECK(within.two > 0.90);
}

TEST_CASE("calib: pictures by estimated rows, weighed by their sigmas") {
  if (test::sanitized) return;
  const ResponseEstimate found = estimated(blobs(256));
  const auto rows = found.response(board().object);
  const auto truth = test::true_response(board(), eye());
  const auto nominal = calib::nominal_response(board().eye, board().object);
  REQUIRE((rows.has_value() && truth.has_value() && nominal.has_value()));
  // The board's own converter, not the session's: its noise does not hide what the rows lack.
  sim::EyeToSimulate quiet = board();
  quiet.sensor.bits = 16;
  const std::vector<double> weighed = test::sample_sigmas(found, quiet);
  const std::vector<double> alike(weighed.size(), quiet.sensor.noise_sigma());
  const auto by_rows = test::median_nmse(*rows, weighed, quiet, eye(), 32);
  const auto unweighed = test::median_nmse(*rows, alike, quiet, eye(), 32);
  const auto by_truth = test::median_nmse(*truth, alike, quiet, eye(), 32);
  const auto by_drawing = test::median_nmse(*nominal, alike, quiet, eye(), 32);
  REQUIRE((by_rows.has_value() && unweighed.has_value() && by_truth.has_value() && by_drawing.has_value()));
  CHECK(*by_truth < 1e-3);
  CHECK(*by_rows < 4e-3);
  CHECK(*by_rows < 0.6 * *unweighed);
  CHECK(*unweighed < 9e-3);
  CHECK(*by_drawing > 0.5);
}

TEST_CASE("calib: any number of threads gives the same bits") {
  const Session from = blobs(96);
  EstimateSettings settings;
  const ResponseEstimate one = estimated(from, settings);
  settings.threads = 3;
  const ResponseEstimate three = estimated(from, settings);
  for (std::size_t m = 0; m < one.rows.size(); ++m) {
    CHECK(one.rows[m].columns == three.rows[m].columns);
    CHECK(one.rows[m].values == three.rows[m].values);
    CHECK(one.rows[m].sigmas == three.rows[m].sigmas);
  }
}

TEST_CASE("calib: rows follow from their parameters") {
  const ResponseEstimate found = estimated(blobs(96));
  calib::SoftCone model(board().eye, board().object);
  for (std::size_t m = 0; m < found.rows.size(); ++m) {
    const calib::RowEstimate& row = found.rows[m];
    const int index = static_cast<int>(m), columns = board().eye.columns;
    const calib::RowSupport support =
        calib::support_of(model, index / columns, index % columns, row.parameters.cone, found.plane);
    const std::vector<double> entries = calib::entries_of(row.parameters, support, 16);
    std::size_t e = 0;
    for (std::size_t j = 0; j < entries.size() && e < row.columns.size(); ++j) {
      if (support.pixels[j] != row.columns[e]) continue;
      CHECK(static_cast<float>(entries[j]) == row.values[e++]);
    }
    CHECK(e == row.columns.size());
  }
}

TEST_CASE("calib: channels that tell nothing or lie never reach the response") {
  Session from = blobs(128);
  const std::size_t channels = static_cast<std::size_t>(board().eye.ommatidia());
  sim::RandomStream random({1, sim::Draws::picture, 9, 9});
  calib::Captures& captures = from.captures;
  for (auto* codes : {&captures.codes, &captures.references.codes, &captures.darks.codes}) {
    for (std::size_t at = 0; at < codes->size(); ++at) {
      const std::size_t m = at % channels;
      if (m == 1) (*codes)[at] = 64.0;                                                     // dead
      if (m == 3) (*codes)[at] += 500.0;                                                   // hot
      if (m == 5) (*codes)[at] += 8.0 * random.gaussian();                                 // noisy
      if (m == 7 && codes == &captures.codes) (*codes)[at] += random.uniform(0.0, 600.0);  // a loose contact
      if (m == 8 && codes == &captures.codes) (*codes)[at] *= 4.0;                         // saturated
    }
  }
  from.noise.saturated_lsb = 3000.0;
  const ResponseEstimate found = estimated(from);
  const std::pair<std::size_t, ChannelStatus> expected[] = {
      {1, ChannelStatus::dead}, {3, ChannelStatus::hot}, {5, ChannelStatus::noisy}, {7, ChannelStatus::does_not_fit}};
  const auto response = found.response(board().object);
  REQUIRE(response.has_value());
  const std::vector<double> sums = response->row_sums();
  for (const auto& each : expected) {
    const std::size_t m = each.first;
    INFO("channel " << m << " is " << name(found.rows[m].status));
    CHECK(found.rows[m].status == each.second);
    CHECK(found.rows[m].columns.empty());
    CHECK(sums[m] == 0.0);
  }
  CHECK(found.rows[0].status == ChannelStatus::good);
  CHECK(sums[0] > 10.0);
}

TEST_CASE("calib: gamma, black level and distance of the display are found") {
  if (test::sanitized) return;
  // Without coma, which turns axes away from the front as a nearer display would.
  sim::EyeToSimulate built = board();
  built.build.coma = 0.0;
  built.object.distance_mm += 1.0;
  const auto moved = test::pixel_responses(built);
  REQUIRE(moved.has_value());
  std::vector<float> grey = test::blob_patterns(16, 16, 256, 77);
  sim::RandomStream random({2, sim::Draws::picture, 3, 3});
  for (std::size_t p = 0; p < 256; ++p) {
    const float bright = static_cast<float>(random.uniform(0.3, 1.0));
    for (std::size_t n = 0; n < 256; ++n) grey[p * 256 + n] *= bright;
  }
  SessionSettings display;
  display.gamma = 2.2;
  display.black_level = 0.01;
  const auto from = test::simulated_session(built, *moved, grey, display);
  REQUIRE(from.has_value());
  const ResponseEstimate found = estimated(*from);
  CHECK(found.gamma == doctest::Approx(2.2).epsilon(0.005));
  CHECK(found.black_level == doctest::Approx(0.01).epsilon(0.15));
  MESSAGE("distance off by " << found.plane.distance_mm << " +- " << found.plane_sigma.distance_mm);
  CHECK(std::abs(found.plane.distance_mm - 1.0) < 3.0 * found.plane_sigma.distance_mm);
  CHECK(found.plane_sigma.distance_mm < 0.5);
}

TEST_CASE("calib: least squares find rows from Hadamard patterns and rasters, with their sigmas") {
  if (test::sanitized) return;
  EstimateSettings settings;
  settings.method = calib::RowMethod::least_squares;
  const ResponseEstimate hadamard = estimated(session(test::sylvester_patterns(256)), settings);
  const ResponseEstimate raster = estimated(session(test::raster_patterns(256)), settings);
  CHECK(median_error(hadamard) < 0.015);
  CHECK(median_error(raster) > 4.0 * median_error(hadamard));
  const Coverage within = coverage(hadamard);
  CHECK(within.one == doctest::Approx(0.68).epsilon(0.05));
  CHECK(within.two == doctest::Approx(0.955).epsilon(0.02));
  const Session few = blobs(64);
  test::check_error(calib::estimate_response(few.captures, few.noise, board().eye, board().object, settings),
                    hal::ErrorCode::unsupported, "least squares", {"256", "64"});
}

TEST_CASE("calib: captures that cannot be used are named") {
  const Session good = blobs(16);
  const auto check = [&](auto&& spoil, hal::ErrorCode code, const std::string& place, const test::Named& named) {
    Session bad = good;
    EstimateSettings settings;
    spoil(bad, settings);
    test::check_error(calib::estimate_response(bad.captures, bad.noise, board().eye, board().object, settings), code,
                      place, named);
  };
  using enum hal::ErrorCode;
  check([](Session& s, EstimateSettings&) { s.captures.patterns.clear(); }, out_of_range, "captures.patterns", {"two"});
  check([](Session& s, EstimateSettings&) { s.captures.patterns[300] = 1.5F; }, out_of_range, "captures.patterns",
        {"1", "44", "1.5"});
  check([](Session& s, EstimateSettings&) { s.captures.codes.pop_back(); }, mismatch, "captures.codes", {});
  check([](Session& s, EstimateSettings&) { s.captures.codes[0] = std::numeric_limits<double>::infinity(); },
        out_of_range, "captures.codes", {"0"});
  check([](Session& s, EstimateSettings&) { std::fill(s.captures.held_out.begin(), s.captures.held_out.end(), 0); },
        mismatch, "captures.held_out", {"0", "16"});
  check([](Session& s, EstimateSettings&) { std::swap(s.captures.darks.time[0], s.captures.darks.time[1]); }, mismatch,
        "captures.darks.time", {});
  check([](Session& s, EstimateSettings&) { s.noise.read_noise_lsb = 0.0; }, out_of_range, "noise.read_noise_lsb", {});
  check([](Session&, EstimateSettings& e) { e.pitch_px = 0.5; }, out_of_range, "estimate.pitch_px", {"0.5"});
  check([](Session&, EstimateSettings& e) { e.threads = 0; }, out_of_range, "estimate.threads", {"0", "1"});
  check(
      [](Session& s, EstimateSettings&) {
        for (auto* codes : {&s.captures.codes, &s.captures.references.codes, &s.captures.darks.codes}) {
          std::fill(codes->begin(), codes->end(), 64.0);
        }
      },
      usage, "captures.codes", {"dead"});
}

TEST_CASE("calib: an estimate can be given up") {
  const Session from = blobs(64);
  int reports = 0;
  const auto stopped = calib::estimate_response(from.captures, from.noise, board().eye, board().object, {},
                                                [&](std::string_view, double, double) { return ++reports < 3; });
  REQUIRE_FALSE(stopped.has_value());
  CHECK(stopped.error().code == hal::ErrorCode::interrupted);
  CHECK(reports == 3);
}
