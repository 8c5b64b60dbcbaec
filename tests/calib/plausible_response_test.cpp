#include "calib/plausible_response.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "calib/row_draws.hpp"
#include "tests/calib/cone_reference.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye;
using namespace compueye::calib;
using hal::EyeGeometry;
using hal::ObjectPlane;
using reference::deg;

namespace {

constexpr BuildErrors no_errors{0.0, 0.0, 0.0, 4.0, 0.0};

EyeGeometry fisheye_of(int n, double interommatidial_deg, double acceptance_deg) {
  EyeGeometry eye;
  eye.rows = eye.columns = n;
  eye.interommatidial_rad = interommatidial_deg * deg;
  eye.acceptance_rad = acceptance_deg * deg;
  return eye;
}

// Every field lies wholly on the plane, some 50 pixels across.
const EyeGeometry roomy_eye = fisheye_of(12, 1.0, 12.0);
constexpr ObjectPlane roomy_plane{120, 120, 18.0, 18.0, 30.0};

recon::Response made(const EyeGeometry& eye, const ObjectPlane& plane, const BuildErrors& errors, std::uint64_t seed) {
  auto response = plausible_response(eye, plane, errors, seed);
  REQUIRE(response.has_value());
  return std::move(*response);
}

/// Centre of mass of every row, pixels.
struct Centres {
  std::vector<double> x, y;
};

Centres centres_of(const recon::Response& a, int cols) {
  Centres centres;
  for (int m = 0; m < a.rows(); ++m) {
    double sum = 0.0, x = 0.0, y = 0.0;
    a.for_each_in_row(m, [&](std::int32_t n, double v) {
      sum += v;
      x += v * (n % cols);
      y += v * (n / cols);
    });
    centres.x.push_back(x / sum);
    centres.y.push_back(y / sum);
  }
  return centres;
}

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

double deviation(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += (v - mean(values)) * (v - mean(values));
  return std::sqrt(sum / static_cast<double>(values.size()));
}

std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b) {
  REQUIRE(a.size() == b.size());
  std::vector<double> c;
  for (std::size_t i = 0; i < a.size(); ++i) c.push_back(a[i] - b[i]);
  return c;
}

bool same(const recon::Response& a, const recon::Response& b) {
  return a.content_hash() == b.content_hash();
}

/// What each entry of row m of the nominal response is multiplied by.
std::vector<double> factors_in_row(const recon::Response& nominal, const recon::Response& a, int m) {
  std::vector<double> at(static_cast<std::size_t>(a.cols()), 0.0), factors;
  a.for_each_in_row(m, [&](std::int32_t n, double v) { at[static_cast<std::size_t>(n)] = v; });
  nominal.for_each_in_row(m, [&](std::int32_t n, double v) {
    if (v > 2.0 * least_plausible_entry) factors.push_back(at[static_cast<std::size_t>(n)] / v);
  });
  return factors;
}

}  // namespace

TEST_CASE("without build errors the response is the nominal one") {
  const auto nominal = nominal_response(roomy_eye, roomy_plane);
  REQUIRE(nominal.has_value());
  const recon::Response a = made(roomy_eye, roomy_plane, no_errors, 1);
  for (int m = 0; m < a.rows(); ++m) {
    for (const double factor : factors_in_row(*nominal, a, m)) REQUIRE(std::abs(factor - 1.0) < 1e-8);
  }
  CHECK(a.nonzeros() <= nominal->nonzeros());
}

TEST_CASE("the pose is off by as much as asked, about both directions") {
  BuildErrors errors = no_errors;
  errors.pose_rad = 0.2 * deg;
  const Centres drawn = centres_of(made(roomy_eye, roomy_plane, no_errors, 3), roomy_plane.cols);
  const Centres built = centres_of(made(roomy_eye, roomy_plane, errors, 3), roomy_plane.cols);
  // The plane is 30 mm from the apexes and a little more along leaning axes.
  const double expected_px = 0.2 * deg * 30.1 / roomy_plane.pixel_width_mm();
  const std::vector<double> dx = difference(built.x, drawn.x), dy = difference(built.y, drawn.y);
  CHECK(deviation(dx) == doctest::Approx(expected_px).epsilon(0.15));
  CHECK(deviation(dy) == doctest::Approx(expected_px).epsilon(0.15));
  CHECK(std::abs(mean(dx)) < 0.25 * expected_px);
  CHECK(std::abs(mean(dy)) < 0.25 * expected_px);
}

TEST_CASE("gains spread as asked and leave the shape of a row alone") {
  BuildErrors errors = no_errors;
  errors.gain = 0.05;
  const auto nominal = nominal_response(roomy_eye, roomy_plane);
  REQUIRE(nominal.has_value());
  const recon::Response a = made(roomy_eye, roomy_plane, errors, 4);
  std::vector<double> gains;
  for (int m = 0; m < a.rows(); ++m) {
    const std::vector<double> factors = factors_in_row(*nominal, a, m);
    gains.push_back(mean(factors));
    CHECK(deviation(factors) < 1e-8);
  }
  CHECK(deviation(gains) == doctest::Approx(0.05).epsilon(0.15));
  CHECK(mean(gains) == doctest::Approx(1.0).epsilon(0.015));
}

TEST_CASE("the residual has the asked rms and changes slowly") {
  BuildErrors errors = no_errors;
  errors.residual = 0.03;
  errors.residual_pitch_px = 6.0;
  const auto nominal = nominal_response(roomy_eye, roomy_plane);
  REQUIRE(nominal.has_value());
  const recon::Response a = made(roomy_eye, roomy_plane, errors, 5);
  double squares = 0.0, steps = 0.0;
  std::size_t count = 0, step_count = 0;
  for (int m = 0; m < a.rows(); ++m) {
    const std::vector<double> factors = factors_in_row(*nominal, a, m);
    for (std::size_t k = 0; k < factors.size(); ++k, ++count) {
      squares += (factors[k] - 1.0) * (factors[k] - 1.0);
      if (k == 0) continue;
      steps += (factors[k] - factors[k - 1]) * (factors[k] - factors[k - 1]);
      ++step_count;
    }
  }
  const double rms = std::sqrt(squares / static_cast<double>(count));
  CHECK(rms == doctest::Approx(0.03).epsilon(0.05));
  // Independent neighbours would differ by 1.4 rms.
  CHECK(std::sqrt(steps / static_cast<double>(step_count)) < 0.4 * rms);
}

TEST_CASE("a soft edge keeps the light and widens the field") {
  BuildErrors errors = no_errors;
  const recon::Response hard = made(roomy_eye, roomy_plane, no_errors, 6);
  const std::vector<double> light = hard.row_sums();
  // As wide as it goes, half angles that were not shrunk would let 5 % more in.
  errors.soft_edge = 1.0;
  const std::vector<double> softest = made(roomy_eye, roomy_plane, errors, 6).row_sums();
  for (std::size_t m = 0; m < light.size(); ++m) CHECK(softest[m] == doctest::Approx(light[m]).epsilon(0.01));
  errors.soft_edge = 0.4;
  const recon::Response soft = made(roomy_eye, roomy_plane, errors, 6);
  const std::vector<double> kept = soft.row_sums();
  for (std::size_t m = 0; m < light.size(); ++m) CHECK(kept[m] == doctest::Approx(light[m]).epsilon(0.01));
  CHECK(soft.nonzeros() > hard.nonzeros() * 5 / 4);
  const auto partial = [](const recon::Response& a) {
    std::size_t count = 0;
    for (const double v : a.values()) count += v > 0.05 && v < 0.95 ? 1U : 0U;
    return count;
  };
  CHECK(partial(soft) > 3 * partial(hard));
}

TEST_CASE("no mirror symmetry is left") {
  const EyeGeometry eye = fisheye_of(8, 1.5, 8.0);
  const ObjectPlane plane{16, 16, 8.0, 8.0, 30.0};
  const auto mirrored_distance = [&](const recon::Response& a) {
    std::vector<double> at(64 * 256, 0.0);
    for (int m = 0; m < 64; ++m) {
      a.for_each_in_row(m, [&](std::int32_t n, double v) { at[static_cast<std::size_t>(m * 256 + n)] = v; });
    }
    double apart = 0.0, size = 0.0;
    for (int m = 0; m < 64; ++m) {
      for (int n = 0; n < 256; ++n) {
        const int mirror_m = m / 8 * 8 + 7 - m % 8, mirror_n = n / 16 * 16 + 15 - n % 16;
        const double v = at[static_cast<std::size_t>(m * 256 + n)];
        const double w = at[static_cast<std::size_t>(mirror_m * 256 + mirror_n)];
        apart += (v - w) * (v - w);
        size += v * v;
      }
    }
    return std::sqrt(apart / size);
  };
  CHECK(mirrored_distance(made(eye, plane, no_errors, 7)) < 1e-6);
  CHECK(mirrored_distance(made(eye, plane, {}, 7)) > 0.02);
}

TEST_CASE("the same seed builds the same eye, another seed another") {
  const recon::Response one = made(roomy_eye, roomy_plane, {}, 8);
  CHECK(same(one, made(roomy_eye, roomy_plane, {}, 8)));
  CHECK_FALSE(same(one, made(roomy_eye, roomy_plane, {}, 9)));
}

TEST_CASE("one effect does not change what another draws") {
  BuildErrors gain_only = no_errors, gain_and_pose = no_errors;
  gain_only.gain = gain_and_pose.gain = 0.05;
  gain_and_pose.pose_rad = 1e-4;
  const std::vector<double> alone = made(roomy_eye, roomy_plane, gain_only, 10).row_sums();
  const std::vector<double> both = made(roomy_eye, roomy_plane, gain_and_pose, 10).row_sums();
  for (std::size_t m = 0; m < alone.size(); ++m) CHECK(both[m] == doctest::Approx(alone[m]).epsilon(1e-3));
}

TEST_CASE("blind rows stay blind, and nothing is negative or tiny") {
  const EyeGeometry eye = fisheye_of(20, 9.0, 40.0);
  const ObjectPlane plane{40, 40, 60.0, 60.0, 10.0};
  const auto nominal = nominal_response(eye, plane);
  REQUIRE(nominal.has_value());
  BuildErrors errors;
  errors.residual = 0.3;
  errors.gain = 0.3;
  const recon::Response a = made(eye, plane, errors, 11);
  const std::vector<double> drawn = nominal->row_sums(), built = a.row_sums();
  int blind = 0;
  for (std::size_t m = 0; m < drawn.size(); ++m) {
    if (drawn[m] > 0.0) continue;
    ++blind;
    CHECK(built[m] == 0.0);
  }
  CHECK(blind > 50);
  for (const double v : a.values()) REQUIRE(v >= least_plausible_entry);
}

TEST_CASE("draws are the same on every platform") {
  RowDraws draws(1, 2);
  CHECK(draws.next_bits() == 7315055658720408282U);
  CHECK(draws.normal() * 65536.0 == -19443.0);
}

TEST_CASE("draws of a row have the moments they promise") {
  double sum = 0.0, squares = 0.0, uniform = 0.0;
  constexpr int rows = 400, each = 50;
  for (int row = 0; row < rows; ++row) {
    RowDraws draws(12, static_cast<std::uint32_t>(row));
    for (int k = 0; k < each; ++k) {
      const double v = draws.normal();
      sum += v;
      squares += v * v;
      uniform += draws.uniform();
    }
  }
  constexpr double count = rows * each;
  CHECK(std::abs(sum / count) < 0.03);
  CHECK(squares / count == doctest::Approx(1.0).epsilon(0.04));
  CHECK(uniform / count == doctest::Approx(0.5).epsilon(0.02));
}

TEST_CASE("bad build errors are named with their range") {
  constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
  struct Case {
    std::string name;
    std::function<void(BuildErrors&)> spoil;
    test::Named named;
  };
  const Case cases[] = {
      {"pose_rad", [](BuildErrors& e) { e.pose_rad = -0.001; }, {"-0.001", "0.1"}},
      {"pose_rad", [](BuildErrors& e) { e.pose_rad = 0.2; }, {"0.2", "0.1"}},
      {"gain", [](BuildErrors& e) { e.gain = not_a_number; }, {"nan", "0.3"}},
      {"residual", [](BuildErrors& e) { e.residual = 0.4; }, {"0.4", "0.3"}},
      {"residual_pitch_px", [](BuildErrors& e) { e.residual_pitch_px = 0.5; }, {"0.5", "1", "1000000"}},
      {"soft_edge", [](BuildErrors& e) { e.soft_edge = 1.1; }, {"1.1", "1"}},
  };
  for (const Case& each : cases) {
    CAPTURE(each.name);
    BuildErrors errors;
    each.spoil(errors);
    const auto response = plausible_response(roomy_eye, roomy_plane, errors, 1);
    test::check_error(response, hal::ErrorCode::out_of_range, "build errors: " + each.name, each.named);
  }
  EyeGeometry eye = roomy_eye;
  eye.acceptance_rad = 3.0;
  CHECK_FALSE(plausible_response(eye, roomy_plane, {}, 1).has_value());
}

TEST_CASE("it can be given up while errors are drawn") {
  bool drawing = false;
  const auto stopped = plausible_response(roomy_eye, roomy_plane, {}, 1, [&](std::string_view what, double, double) {
    drawing = what == "build errors";
    return !drawing;
  });
  REQUIRE_FALSE(stopped.has_value());
  CHECK(drawing);
  CHECK(stopped.error().code == hal::ErrorCode::interrupted);
}
