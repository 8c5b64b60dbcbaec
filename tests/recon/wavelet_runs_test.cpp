#include "recon/core/operators/wavelet_runs.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "calib/plausible_response.hpp"
#include "recon/core/operators/wavelet_picture.hpp"
#include "recon/reconstructor.hpp"
#include "recon/setup/gram_matrix.hpp"
#include "recon/setup/operator_list.hpp"
#include "recon/setup/quantised_response.hpp"
#include "recon/setup/rounded_form.hpp"
#include "recon/setup/wavelet_rounding.hpp"
#include "recon/setup/wavelet_run_tables.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/recon/random_problem.hpp"
#include "tests/recon/solve_frame.hpp"
#include "tests/sanitized.hpp"

using namespace compueye;
using namespace compueye::tests;
using recon::OperatorKind;
using recon::Response;

namespace {

struct NamedMatrix {
  const char* name;
  Response a;
};

/// Soft, uneven fields some ten to twenty pixels across.
Response measured_rows(int rows, int cols, int side) {
  hal::EyeGeometry eye;
  eye.rows = eye.columns = side;
  eye.interommatidial_rad = 4.5 * std::numbers::pi / 180.0;
  eye.acceptance_rad = 60.0 * std::numbers::pi / 180.0;
  return calib::plausible_response(eye, {rows, cols, 60.0, 60.0, 10.0}, {}, 3).value();
}

std::vector<NamedMatrix> smooth_matrices() {
  Random random(111);
  const Response eye = measured_rows(100, 97, test::sanitized ? 5 : 9);
  std::vector<NamedMatrix> all;
  all.push_back({"eye with blind rows", eye.without_rows(std::vector<int>{3, 4, 5, 6, 11})});
  all.push_back({"odd picture", random_response(random, 7, Picture{17, 19}, 1.0)});
  all.push_back({"sparse and of both signs", random_response(random, 9, Picture{16, 33}, 0.05)});
  all.push_back({"one row", random_response(random, 1, Picture{16, 16}, 0.5)});
  return all;
}

template <class T>
std::vector<T> to_precision(const std::vector<double>& v) {
  return std::vector<T>(v.begin(), v.end());
}

/// Against the rounded matrix in double. A sum through S' has some thirty more roundings on its way than its terms, and
/// lifting may make numbers five times as large; of the picture's terms none may be lost.
template <class T>
void check_against_double(const Response& exact) {
  Random random(112);
  const Response whole = recon::quantised(exact, OperatorKind::wavelet_runs);
  const Response a = whole.select_rows(whole.seeing_rows());
  recon::KeptTables kept;
  const auto op = recon::make_operator<T>(a, OperatorKind::wavelet_runs, kept).value();
  CHECK(op.kind == OperatorKind::wavelet_runs);
  CHECK(recon::core::bytes(op) == kept.bytes());
  const auto x = to_precision<T>(random_vector(random, a.cols())), u = to_precision<T>(random_vector(random, a.rows()));
  std::vector<T> y(u.size(), T(7)), back(x.size(), T(1)), scratch(op.scratch_size());
  recon::core::forward(op, x.data(), y.data(), scratch.data());
  recon::core::adjoint_accumulate(op, u.data(), back.data(), scratch.data());
  std::vector<double> forward(y.size()), adjoint(x.size());
  a.forward(std::vector<double>(x.begin(), x.end()), forward);
  a.adjoint(std::vector<double>(u.begin(), u.end()), adjoint);
  const auto epsilon = static_cast<double>(std::numeric_limits<T>::epsilon());
  double size_x = 0.0, size_u = 0.0, left = 0.0, right = 0.0;
  for (const T v : x) size_x += static_cast<double>(v) * static_cast<double>(v);
  for (const T v : u) size_u += static_cast<double>(v) * static_cast<double>(v);
  for (std::size_t m = 0; m < y.size(); ++m) {
    double row = 0.0;
    a.for_each_in_row(static_cast<int>(m), [&](std::int32_t, double v) { row += v * v; });
    CHECK(std::abs(static_cast<double>(y[m]) - forward[m]) <= 16.0 * epsilon * std::sqrt(row * size_x));
    left += static_cast<double>(y[m]) * static_cast<double>(u[m]);
  }
  const double most = 16.0 * epsilon * std::sqrt(a.squared_norm() * size_u);
  for (std::size_t n = 0; n < x.size(); ++n) {
    CHECK(std::abs(static_cast<double>(back[n]) - 1.0 - adjoint[n]) <= most + epsilon);
    right += (static_cast<double>(back[n]) - 1.0) * static_cast<double>(x[n]);
  }
  CHECK(std::abs(left - right) <= 16.0 * epsilon * std::sqrt(a.squared_norm() * size_x * size_u));
}

double relative_distance(const std::vector<double>& a, const std::vector<double>& b) {
  double off = 0.0, size = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    off += (a[k] - b[k]) * (a[k] - b[k]);
    size += a[k] * a[k];
  }
  return std::sqrt(off / size);
}

}  // namespace

TEST_CASE("a picture is put together from what it was taken apart into, and measuring is the transpose of that") {
  Random random(113);
  for (const Picture& picture : {Picture{2, 2}, {3, 5}, {16, 16}, {17, 35}, {40, 31}, {64, 48}}) {
    const int rows = picture.rows, cols = picture.cols;
    CAPTURE(rows);
    CAPTURE(cols);
    const recon::core::WaveletPicture shape{static_cast<std::size_t>(rows), static_cast<std::size_t>(cols)};
    const auto x = random_vector(random, rows * cols);
    std::vector<double> c(shape.coefficients(), 7.0), measured(c), back(x.size(), 7.0), scratch(shape.scratch_size(1));
    recon::core::wavelet_analyse(shape, x.data(), c.data(), scratch.data());
    recon::core::wavelet_synthesise(shape, c.data(), back.data(), scratch.data());
    CHECK(relative_distance(x, back) < 1e-13);
    const auto z = random_vector(random, rows * cols);
    recon::core::wavelet_measure(shape, z.data(), measured.data(), scratch.data());
    double along_pixels = 0.0, along_coefficients = 0.0, size = 0.0;
    for (std::size_t k = 0; k < x.size(); ++k) along_pixels += x[k] * z[k];
    for (std::size_t k = 0; k < c.size(); ++k) along_coefficients += c[k] * measured[k];
    for (const double v : x) size += v * v;
    CHECK(std::abs(along_pixels - along_coefficients) < 1e-13 * size * 4.0);
  }
}

TEST_CASE("a plane has no details, a white pixel has those of the 9/7 filters") {
  const recon::core::WaveletPicture shape{64, 64};
  std::vector<double> x(64 * 64, 0.0), c(shape.coefficients()), scratch(shape.scratch_size(1));
  for (std::size_t k = 0; k < x.size(); ++k) x[k] = 3.0;
  recon::core::wavelet_analyse(shape, x.data(), c.data(), scratch.data());
  // Two levels of a root of two each, down and across, make an average four times as large.
  for (std::size_t k = 0; k < shape.averages(); ++k) CHECK(c[k] == doctest::Approx(12.0).epsilon(1e-9));
  for (std::size_t k = shape.averages(); k < c.size(); ++k) CHECK(std::abs(c[k]) < 1e-9);
  // The centre taps of Antonini, Barlaud, Mathieu & Daubechies (1992), table I, .602949 and 1.115087, times a root of
  // two over one and two: an even pixel's average and an odd one's detail.
  std::fill(x.begin(), x.end(), 0.0);
  x[33 * 64 + 33] = 1.0;
  recon::core::wavelet_analyse(shape, x.data(), c.data(), scratch.data());
  double largest = 0.0;
  for (std::size_t k = shape.averages(); k < c.size(); ++k) largest = std::max(largest, std::abs(c[k]));
  CHECK(largest == doctest::Approx(std::pow(1.115087052456994 / std::numbers::sqrt2, 2)).epsilon(1e-6));
}

TEST_CASE("wavelet runs are the rounded matrix and its transpose within the rounding of their sums") {
  for (const NamedMatrix& named : smooth_matrices()) {
    CAPTURE(named.name);
    check_against_double<float>(named.a);
    check_against_double<double>(named.a);
  }
}

TEST_CASE("rows of a measured eye are held to less than its calibration leaves, in fewer numbers") {
  const Response a = measured_rows(96, 96, test::sanitized ? 4 : 12);
  const Response rounded = recon::quantised(a, OperatorKind::wavelet_runs);
  CHECK(recon::worst_row_error(a, rounded) < recon::most_row_error);
  CHECK(recon::worst_row_error(a, rounded) > 1e-4);  // or nothing was left out
  CHECK(recon::rounded_in_wavelets(rounded).content_hash() == rounded.content_hash());
  const Response seeing = rounded.select_rows(rounded.seeing_rows());
  recon::KeptTables kept, all;
  const auto wavelets = recon::make_operator<float>(seeing, OperatorKind::wavelet_runs, kept).value();
  const Response whole = a.select_rows(a.seeing_rows());
  const auto runs = recon::make_operator<float>(whole, OperatorKind::dense_runs, all).value();
  // Fewer rows have fewer tiles in common.
  CHECK(recon::core::bytes(wavelets) * 5 < recon::core::bytes(runs) * (test::sanitized ? 3 : 2));
}

TEST_CASE("a row's error is the distance of its pictures") {
  const auto rows = [](double second) {
    std::vector<double> values(2 * 256, 0.0);
    values[0] = 3.0;
    values[256 + 9] = 4.0;
    values[256 + 10] = second;
    return Response::from_dense(2, 256, values).value().with_image(16, 16).value();
  };
  CHECK(recon::worst_row_error(rows(3.0), rows(3.0)) == 0.0);
  CHECK(recon::worst_row_error(rows(3.0), rows(0.0)) == doctest::Approx(0.6));
}

TEST_CASE("rows that are not smooth are applied with every digit, and small eyes are by rule") {
  Random random(114);
  // So little of it in every tile that each is negligible, and so much in all of them that the row is not.
  std::vector<double> values;
  for (int n = 0; n < 2 * 96 * 96; ++n) values.push_back(0.5 + (n % 96) / 96.0 + random.uniform(-0.02, 0.02));
  const Response noise = Response::from_dense(2, 96 * 96, values).value().with_image(96, 96).value();
  const Response rounded = recon::quantised(noise, OperatorKind::wavelet_runs);
  CHECK(recon::worst_row_error(noise, rounded) > recon::most_row_error);
  CHECK(recon::keeps_details(noise, rounded));
  CHECK_FALSE(recon::rounded_form(noise, OperatorKind::wavelet_runs).has_value());
  recon::Objective objective;
  objective.lambda = 0.1;
  recon::Plan plan;
  plan.op = OperatorKind::wavelet_runs;
  const auto exact = recon::Reconstructor::create(noise, objective, plan);
  REQUIRE(exact.has_value());
  CHECK_FALSE(exact->plan().op.has_value());
  CHECK(exact->operating_point().op != OperatorKind::wavelet_runs);
  const Response smooth = measured_rows(48, 48, 4);
  const auto made = recon::Reconstructor::create(smooth, objective, plan);
  REQUIRE(made.has_value());
  CHECK(made->operating_point().op == OperatorKind::wavelet_runs);
  CHECK_FALSE(recon::rounded_form(smooth, std::nullopt).has_value());
  CHECK_FALSE(recon::rounded_form(smooth, OperatorKind::csr).has_value());
  const auto tiny = recon::Reconstructor::create(random_response(random, 4, Picture{8, 40}, 1.0), objective, plan);
  test::check_error(tiny, hal::ErrorCode::unsupported, "operator",
                    {std::to_string(recon::least_wavelet_side), "8", "40", "dense-runs"});
}

TEST_CASE("a large measured eye is in wavelet runs by rule, and A A' is that of the rounded rows") {
  if (test::sanitized) return;  // four million entries and one
  constexpr int rows = 330, side = 160, reach = 64;
  std::vector<std::int64_t> start{0};
  std::vector<std::int32_t> columns;
  std::vector<double> values;
  for (int m = 0; m < rows; ++m) {
    const int row = reach + m % 33, col = reach + m / 33 * 3;
    for (int r = 0; r < side; ++r) {
      for (int c = 0; c < side; ++c) {
        const double square = ((r - row) * (r - row) + (c - col) * (c - col)) / double{reach * reach};
        if (square >= 1.0) continue;
        columns.push_back(r * side + c);
        values.push_back((1.0 - square) * (1.0 - square) * (1.0 + 0.001 * (m % 7) * (r % 40)));
      }
    }
    start.push_back(static_cast<std::int64_t>(values.size()));
  }
  const Response a =
      Response::from_csr(rows, side * side, start, columns, values).value().with_image(side, side).value();
  REQUIRE(a.nonzeros() >= recon::streamed_entries);
  const auto form = recon::rounded_form(a, std::nullopt);
  REQUIRE(form.has_value());
  CHECK(form->kind == OperatorKind::wavelet_runs);
  CHECK(form->response.rounded_for() == OperatorKind::wavelet_runs);
  // Not once more, nor in another form unless it is asked for.
  CHECK(recon::rounded_form(form->response, std::nullopt)->response.values().data() == form->response.values().data());
  CHECK_FALSE(recon::rounded_form(form->response, OperatorKind::csr).has_value());
  const recon::GramMatrix gram(form->response, recon::MetricKind::identity);
  auto scratch = gram.make_scratch();
  std::vector<double> found(rows), first(static_cast<std::size_t>(side * side), 0.0), expected(rows);
  gram.row(5, scratch, found);
  form->response.for_each_in_row(5, [&](std::int32_t n, double v) { first[static_cast<std::size_t>(n)] = v; });
  form->response.forward(first, expected);
  for (std::size_t m = 0; m < found.size(); ++m) CHECK(found[m] == doctest::Approx(expected[m]).epsilon(1e-12));
}

TEST_CASE("a frame with wavelet runs is one of the rounded matrix") {
  const Response a = measured_rows(48, 48, 4);
  Random random(115);
  recon::Objective objective;
  objective.lambda = 0.1;
  objective.constraint = recon::ConstraintKind::nonnegative;
  recon::Plan plan;
  plan.precision = recon::Precision::f64;
  plan.iterations = 40;
  plan.op = OperatorKind::wavelet_runs;
  const Response rounded = recon::quantised(a, OperatorKind::wavelet_runs);
  const std::vector<float> y = to_float(random_vector(random, a.rows(), 1.0, 20.0));
  const SolvedFrame in_wavelets = solve_frame(recon::Reconstructor::create(a, objective, plan).value(), y);
  plan.op = OperatorKind::csr;
  const SolvedFrame in_entries = solve_frame(recon::Reconstructor::create(rounded, objective, plan).value(), y);
  CHECK(in_wavelets.info.health != recon::Health::invalid);
  CHECK(in_wavelets.info.objective == doctest::Approx(in_entries.info.objective).epsilon(1e-9));
  for (std::size_t n = 0; n < in_wavelets.x.size(); ++n) {
    CHECK(std::abs(in_wavelets.x[n] - in_entries.x[n]) <= 1e-5F * (1.0F + std::abs(in_entries.x[n])));
  }
}
