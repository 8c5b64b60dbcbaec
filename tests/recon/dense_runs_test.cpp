#include "recon/core/operators/dense_runs.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "calib/plausible_response.hpp"
#include "recon/setup/dense_run_tables.hpp"
#include "recon/setup/operator_list.hpp"
#include "recon/setup/quantised_response.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/recon/random_problem.hpp"

using namespace compueye;
using namespace compueye::tests;
using recon::OperatorKind;
using recon::Response;

namespace {

struct Measured {
  std::string name;
  Response a;
};

Response measured_rows(int side, double interommatidial_deg, double acceptance_deg, const hal::ObjectPlane& plane) {
  constexpr double deg = std::numbers::pi / 180.0;
  hal::EyeGeometry eye;
  eye.rows = eye.columns = side;
  eye.interommatidial_rad = interommatidial_deg * deg;
  eye.acceptance_rad = acceptance_deg * deg;
  const Response a = calib::plausible_response(eye, plane, {}, 3).value();
  return a.select_rows(a.seeing_rows());
}

/// Zero rows, rows that see the picture's last pixel, negative entries.
Response with_zero_rows(Random& random, int rows, int cols) {
  std::vector<double> values;
  for (int m = 0; m < rows; ++m) {
    for (int n = 0; n < cols; ++n) values.push_back(m % 3 == 1 || n < cols / 2 ? 0.0 : random.uniform(-1.0, 1.0));
  }
  return Response::from_dense(rows, cols, values).value();
}

std::vector<Measured> matrices() {
  Random random(81);
  std::vector<Measured> all;
  all.push_back({"small eye", measured_rows(8, 1.5, 8.0, {16, 16, 8, 8, 30})});
  all.push_back({"large picture", measured_rows(11, 10.0, 60.0, {100, 97, 60, 60, 10})});
  all.push_back({"one group", random_response(random, 5, Picture{4, 4}, 1.0)});
  all.push_back({"a group and a pixel", random_response(random, 6, Picture{1, 17}, 1.0)});
  all.push_back({"sparse", random_response(random, 33, Picture{15, 20}, 0.03)});
  all.push_back({"zero rows", with_zero_rows(random, 10, 70).with_image(7, 10).value()});
  return all;
}

constexpr OperatorKind kinds[] = {OperatorKind::dense_runs, OperatorKind::dense_runs_bf16,
                                  OperatorKind::dense_runs_int8};

template <class T>
std::vector<T> cast(const std::vector<double>& v) {
  std::vector<T> out;
  for (const double each : v) out.push_back(static_cast<T>(each));
  return out;
}

/// Higham, "Accuracy and Stability", eq. 3.5, for `additions` one after the other, an entry rounded to T, a product and
/// a scale.
template <class T>
double bound(double additions, double magnitude) {
  return (additions + 4.0) * 0.5 * static_cast<double>(std::numeric_limits<T>::epsilon()) * magnitude * 1.01;
}

template <class T>
void check_against_double(const Measured& measured, OperatorKind kind) {
  Random random(82);
  const Response a = recon::quantised(measured.a, kind);
  recon::KeptTables kept;
  const auto op = recon::make_operator<T>(a, kind, kept).value();
  CHECK(op.kind == kind);
  CHECK(op.scratch_size() == 0);
  CHECK(recon::core::bytes(op) == kept.bytes());
  const auto x = cast<T>(random_vector(random, a.cols())), u = cast<T>(random_vector(random, a.rows()));
  std::vector<T> y(u.size(), T(7)), back(x.size(), T(1));
  recon::core::forward(op, x.data(), y.data(), nullptr);
  recon::core::adjoint_accumulate(op, u.data(), back.data(), nullptr);

  std::vector<double> magnitude(x.size(), 1.0), exact_back(x.size(), 1.0);
  double forward_dot = 0.0, adjoint_dot = 0.0, allowed_dot = 0.0;
  for (int m = 0; m < a.rows(); ++m) {
    const auto of_row = static_cast<double>(u[static_cast<std::size_t>(m)]);
    double exact = 0.0, size = 0.0;
    int terms = 0;
    a.for_each_in_row(m, [&](std::int32_t n, double v) {
      const auto at = static_cast<std::size_t>(n);
      exact += v * static_cast<double>(x[at]);
      size += std::abs(v * static_cast<double>(x[at]));
      exact_back[at] += v * of_row;
      magnitude[at] += std::abs(v * of_row);
      ++terms;
    });
    // No more than every term in one lane, then the tree.
    const double allowed = bound<T>(terms + 4.0, size);
    CHECK(std::abs(static_cast<double>(y[static_cast<std::size_t>(m)]) - exact) <= allowed);
    forward_dot += static_cast<double>(y[static_cast<std::size_t>(m)]) * of_row;
    allowed_dot += allowed * std::abs(of_row);
  }
  for (std::size_t n = 0; n < x.size(); ++n) {
    const double allowed = bound<T>(a.rows() + 1.0, magnitude[n]);
    CHECK(std::abs(static_cast<double>(back[n]) - exact_back[n]) <= allowed);
    adjoint_dot += (static_cast<double>(back[n]) - 1.0) * static_cast<double>(x[n]);
    allowed_dot += allowed * std::abs(static_cast<double>(x[n]));
  }
  CHECK(std::abs(forward_dot - adjoint_dot) <= allowed_dot + 1e-14);
}

OperatorKind chosen(const Response& a) {
  recon::KeptTables kept;
  return recon::make_operator<float>(a, std::nullopt, kept).value().kind;
}

}  // namespace

TEST_CASE("dense runs are the stored matrix and its transpose within the bound of their sums") {
  for (const Measured& measured : matrices()) {
    CAPTURE(measured.name);
    for (const OperatorKind kind : kinds) {
      CAPTURE(static_cast<int>(kind));
      check_against_double<float>(measured, kind);
      check_against_double<double>(measured, kind);
    }
  }
}

TEST_CASE("a sum of dense runs has the order that is written down, to the bit") {
  // Whole numbers over powers of two, so that products are exact and only the order of additions is left.
  Random random(83);
  std::vector<double> values;
  for (int k = 0; k < 5 * 50; ++k) values.push_back(random.below(127) - 63.0);
  values[0] = 127.0;
  for (std::size_t m = 0; m < 5; ++m) values[50 * m] = 127.0;  // a scale of one
  const Response a = Response::from_dense(5, 50, values).value().with_image(5, 10).value();
  std::vector<float> x;
  for (int n = 0; n < 50; ++n)
    x.push_back(static_cast<float>(random.below(1 << 14)) * 0x1p-30F + (n % 7 == 0 ? 1.0F : 0.0F));
  float expected[5];
  for (std::size_t m = 0; m < 5; ++m) {
    // 50 pixels: groups at 0, 16, 32 and, reaching back, 34 for the last two.
    float lane[16] = {};
    for (std::size_t n = 0; n < 48; ++n) lane[n % 16] += static_cast<float>(values[50 * m + n]) * x[n];
    for (std::size_t n = 48; n < 50; ++n) lane[n - 34] += static_cast<float>(values[50 * m + n]) * x[n];
    for (std::size_t half = 8; half > 0; half /= 2) {
      for (std::size_t l = 0; l < half; ++l) lane[l] += lane[l + half];
    }
    expected[m] = lane[0];
  }
  for (const OperatorKind kind : kinds) {
    recon::KeptTables kept;
    const auto op = recon::make_operator<float>(recon::quantised(a, kind), kind, kept).value();
    float y[5];
    recon::core::forward(op, x.data(), y, nullptr);
    for (std::size_t m = 0; m < 5; ++m) CHECK(y[m] == expected[m]);
  }
}

TEST_CASE("tables of dense runs take exactly the bytes of their values, runs and bands") {
  Random random(84);
  const Response a = random_response(random, 6, Picture{8, 8}, 1.0);
  for (const auto& [stored, bytes] : {std::pair{recon::core::RunValues::full, 4U},
                                      {recon::core::RunValues::bf16, 2U},
                                      {recon::core::RunValues::int8, 1U}}) {
    const auto tables = recon::dense_run_tables<float>(a, stored).value();
    // Two blocks of four rows, each one run of four groups; one band.
    const std::size_t scales = stored == recon::core::RunValues::int8 ? 8 * 4 : 0;
    CHECK(tables.bytes() == 2 * 4 * 64 * bytes + 2 * (4 + 2) + 2 * (3 * 4) + 8 * 4 + scales);
    CHECK(recon::core::flops(tables.view) == 2 * 4 * 64);
    CHECK(recon::dense_run_values(a) == 2 * 4 * 64);
  }
}

TEST_CASE("rounding keeps int8 to half a step and bf16 to half a unit, and twice is once") {
  Random random(85);
  const Response a = measured_rows(8, 1.5, 8.0, {16, 16, 8, 8, 30});
  const Response in_int8 = recon::quantised(a, OperatorKind::dense_runs_int8);
  const Response in_bf16 = recon::quantised(a, OperatorKind::dense_runs_bf16);
  CHECK(recon::quantised(a, OperatorKind::csr).content_hash() == a.content_hash());
  for (const Response& once : {in_int8, in_bf16}) {
    // The same entries, of which nobody says that they were rounded.
    const Response untold =
        Response::from_csr(once.rows(), once.cols(), {once.row_start().begin(), once.row_start().end()},
                           {once.columns().begin(), once.columns().end()}, {once.values().begin(), once.values().end()})
            .value();
    CHECK_FALSE(untold.rounded_for().has_value());
    CHECK(recon::quantised(untold, *once.rounded_for()).content_hash() == once.content_hash());
  }
  for (int m = 0; m < a.rows(); ++m) {
    std::vector<double> exact(256, 0.0), eight(256, 0.0), brain(256, 0.0);
    double largest = 0.0;
    a.for_each_in_row(m, [&](std::int32_t n, double v) {
      exact[static_cast<std::size_t>(n)] = v;
      largest = std::max(largest, std::abs(v));
    });
    in_int8.for_each_in_row(m, [&](std::int32_t n, double v) { eight[static_cast<std::size_t>(n)] = v; });
    in_bf16.for_each_in_row(m, [&](std::int32_t n, double v) { brain[static_cast<std::size_t>(n)] = v; });
    for (std::size_t n = 0; n < 256; ++n) {
      CHECK(std::abs(eight[n] - exact[n]) <= 0.5 * largest / 127.0 * (1.0 + 1e-5));
      CHECK(std::abs(brain[n] - exact[n]) <= 0x1p-8 * std::abs(exact[n]) * (1.0 + 1e-5));
    }
  }
  // Halfway cases go to the even neighbour; what a float cannot hold normally is nought; nothing becomes infinite.
  CHECK(recon::bf16_of(1.0 + 0x1p-8) == 0x3F80);
  CHECK(recon::bf16_of(1.0 + 0x1.8p-7) == 0x3F82);
  CHECK(recon::bf16_of(-1.0 - 0x1.1p-8) == 0xBF81);
  CHECK(recon::bf16_of(1e-39) == 0);
  CHECK(std::isfinite(recon::float_of_bf16(recon::bf16_of(3.4e38))));
  CHECK(recon::int8_scale(1e-31) == 0.0F);
  CHECK(recon::int8_of(-5.0, 5.0F / 127.0F) == -127);
}

TEST_CASE("a pixel that is not finite spoils the rows that see it") {
  const Response a = Response::from_dense(2, 64,
                                          [] {
                                            std::vector<double> v(128, 0.0);
                                            v[3] = 1.0;
                                            v[64 + 50] = 1.0;
                                            return v;
                                          }())
                         .value()
                         .with_image(8, 8)
                         .value();
  for (const OperatorKind kind : kinds) {
    recon::KeptTables kept;
    const auto op = recon::make_operator<float>(a, kind, kept).value();
    std::vector<float> x(64, 1.0F), y(2);
    x[50] = std::nanf("");
    recon::core::forward(op, x.data(), y.data(), nullptr);
    CHECK(std::isnan(y[1]));
  }
}

TEST_CASE("measured rows are applied as dense runs, flat and dense ones are not") {
  CHECK(chosen(measured_rows(24, 4.5, 60.0, {96, 96, 60, 60, 10})) == OperatorKind::dense_runs);
  Random random(86);
  CHECK(chosen(random_response(random, 20, Picture{16, 16}, 1.0)) == OperatorKind::dense);
  CHECK(chosen(random_response(random, 20, Picture{16, 16}, 0.05)) == OperatorKind::csr);
}

TEST_CASE("an operator that the response does not fit is refused in a sentence that names others") {
  const Response measured = measured_rows(8, 1.5, 8.0, {16, 16, 8, 8, 30});
  recon::Objective objective;
  objective.lambda = 0.1;
  recon::Plan plan;
  plan.op = OperatorKind::running_sums;
  const auto sums = recon::Reconstructor::create(measured, objective, plan);
  test::check_error(sums, hal::ErrorCode::unsupported, "operator",
                    {std::to_string(measured.nonzeros()), "dense-runs", "csr", "dense"});
  Random random(87);
  plan.op = OperatorKind::dense_runs_int8;
  const auto tiny = recon::Reconstructor::create(random_response(random, 4, Picture{3, 4}, 1.0), objective, plan);
  test::check_error(tiny, hal::ErrorCode::unsupported, "operator",
                    {std::to_string(recon::least_run_pixels), "12", "dense", "csr"});
  for (const OperatorKind kind : {OperatorKind::dense, OperatorKind::csr, OperatorKind::dense_runs}) {
    plan.op = kind;
    const auto made = recon::Reconstructor::create(measured, objective, plan);
    REQUIRE(made.has_value());
    CHECK(made->operating_point().op == kind);
  }
}
