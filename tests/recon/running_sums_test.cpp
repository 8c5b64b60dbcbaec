#include "recon/core/operators/running_sums.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "calib/nominal.hpp"
#include "calib/plausible_response.hpp"
#include "recon/setup/operator_list.hpp"
#include "recon/setup/running_sum_tables.hpp"
#include "tests/recon/random_problem.hpp"
#include "tests/recon/solve_frame.hpp"

using namespace compueye;
using namespace compueye::tests;
using recon::Response;

namespace {

struct SummedEye {
  std::string name;
  Response a;  // seeing rows
};

hal::EyeGeometry geometry(int side, double interommatidial_deg, double acceptance_deg) {
  constexpr double deg = std::numbers::pi / 180.0;
  hal::EyeGeometry eye;
  eye.rows = eye.columns = side;
  eye.interommatidial_rad = interommatidial_deg * deg;
  eye.acceptance_rad = acceptance_deg * deg;
  return eye;
}

Response seeing(const Response& a) {
  return a.select_rows(a.seeing_rows());
}

/// A run of ones with fractions at its ends on every pixel row, anywhere in the picture.
Response random_runs(Random& random, int count, int rows, int cols) {
  std::vector<double> values;
  for (int m = 0; m < count; ++m) {
    for (int r = 0; r < rows; ++r) {
      const double begin = random.uniform(-1.0, cols), end = begin + random.uniform(0.0, cols);
      for (int c = 0; c < cols; ++c) values.push_back(std::clamp(std::min(end - c, c + 1.0 - begin), 0.0, 1.0));
    }
  }
  return seeing(Response::from_dense(count, rows * cols, values).value().with_image(rows, cols).value());
}

std::vector<SummedEye> eyes() {
  Random random(61);
  std::vector<SummedEye> all;
  const auto nominal = [&](int side, double dphi, double acceptance, const hal::ObjectPlane& plane) {
    all.push_back({"nominal " + std::to_string(side),
                   seeing(calib::nominal_response(geometry(side, dphi, acceptance), plane).value())});
  };
  nominal(8, 1.5, 8.0, {16, 16, 8, 8, 30});
  nominal(7, 1.5, 8.0, {16, 16, 8, 8, 30});  // rows that are their own mirror images
  nominal(8, 1.5, 8.0, {15, 16, 8, 8, 30});  // a centre row of pixels
  nominal(16, 9.0, 60.0, {32, 48, 60, 60, 10});
  nominal(10, 9.0, 60.0, {96, 96, 60, 60, 10});  // large enough for bands
  const hal::ObjectPlane plane{32, 32, 60, 60, 10};
  all.push_back({"measured", seeing(calib::plausible_response(geometry(12, 10.0, 60.0), plane, {}, 3).value())});
  for (const auto& [rows, cols] : {std::pair{1, 1}, {1, 9}, {9, 1}, {6, 7}, {7, 6}, {5, 5}, {101, 97}}) {
    all.push_back({"runs " + std::to_string(rows) + "x" + std::to_string(cols), random_runs(random, 11, rows, cols)});
  }
  return all;
}

template <class T>
std::vector<T> in_precision(const std::vector<double>& v) {
  std::vector<T> out;
  for (const double each : v) out.push_back(static_cast<T>(each));
  return out;
}

/// Every rounding of a tap moves a running sum of at most cols / 2 pixels of magnitude one by half a unit, as does
/// every addition within that sum, and the sum over all taps once more.
template <class T>
double bound(const SummedEye& eye, int m) {
  double differences = 0.0, entries = 0.0, before = 0.0;
  std::int32_t last = -2;
  int taps = 0;
  eye.a.for_each_in_row(m, [&](std::int32_t n, double v) {
    const double step = n == last + 1 ? std::abs(v - before) : std::abs(v) + std::abs(before);
    differences += step;
    taps += step > 0.0 ? 1 : 0;
    entries += std::abs(v);
    before = v;
    last = n;
  });
  differences += std::abs(before);
  const double unit = 0.5 * static_cast<double>(std::numeric_limits<T>::epsilon());
  const double longest_sum = 0.5 * eye.a.image_cols() + 1.0;
  return unit * (differences * longest_sum * (longest_sum + 0.25 * taps + 8.0) + 2.0 * entries);
}

template <class T>
void check_against_double(const SummedEye& eye, const recon::MirrorSymmetry& symmetry,
                          const std::vector<std::int32_t>& transposed, std::size_t at_once) {
  Random random(62);
  const auto tables = recon::running_sum_tables<T>(eye.a, symmetry, transposed);
  REQUIRE(tables.has_value());
  CHECK(tables->view.rows_at_once == at_once);
  CHECK(recon::core::bytes(tables->view) == tables->bytes());
  const recon::AlignedWorkspace memory(tables->view.scratch_size() * sizeof(T));
  auto* scratch = reinterpret_cast<T*>(memory.span().data());
  const auto x = random_vector(random, eye.a.cols()), u = random_vector(random, eye.a.rows());
  const auto xt = in_precision<T>(x), ut = in_precision<T>(u);
  std::vector<T> y(u.size()), back(x.size(), T(1));
  recon::core::forward(tables->view, xt.data(), y.data(), scratch);
  recon::core::adjoint_accumulate(tables->view, ut.data(), back.data(), scratch);
  const std::vector<double> xd(xt.begin(), xt.end()), ud(ut.begin(), ut.end());
  std::vector<double> exact(u.size()), exact_back(x.size());
  eye.a.forward(xd, exact);
  eye.a.adjoint(ud, exact_back);
  double worst_bound = 0.0;
  for (int m = 0; m < eye.a.rows(); ++m) {
    const double allowed = bound<T>(eye, m);
    CHECK(std::abs(static_cast<double>(y[static_cast<std::size_t>(m)]) - exact[static_cast<std::size_t>(m)]) <=
          allowed);
    worst_bound += allowed;
  }
  for (std::size_t n = 0; n < x.size(); ++n)
    CHECK(std::abs(static_cast<double>(back[n]) - 1.0 - exact_back[n]) <= worst_bound);
  double forward_dot = 0.0, adjoint_dot = 0.0;
  for (std::size_t m = 0; m < u.size(); ++m) forward_dot += static_cast<double>(y[m]) * ud[m];
  for (std::size_t n = 0; n < x.size(); ++n) adjoint_dot += (static_cast<double>(back[n]) - 1.0) * xd[n];
  CHECK(std::abs(forward_dot - adjoint_dot) <= worst_bound * std::sqrt(static_cast<double>(x.size())));
}

}  // namespace

TEST_CASE("running sums are A and A' within the bound of their sums, with symmetry and without") {
  int with_four = 0, with_eight = 0, banded = 0;
  for (const SummedEye& eye : eyes()) {
    CAPTURE(eye.name);
    const auto found = recon::find_mirror_symmetry(eye.a);
    const auto transposed = recon::find_diagonal_symmetry(eye.a);
    const recon::MirrorSymmetry none{{found.permutations.front()}, {{1}}};
    const bool four = found.order() == 4 && eye.a.image_rows() % 2 == 0 && eye.a.image_cols() % 2 == 0;
    const bool eight = four && eye.a.image_rows() == eye.a.image_cols() && !transposed.empty();
    with_four += four ? 1 : 0;
    with_eight += eight ? 1 : 0;
    banded += recon::running_sum_tables<float>(eye.a, none)->view.bands > 1 ? 1 : 0;
    if (eight) check_against_double<float>(eye, found, transposed, 8);
    if (eight) check_against_double<double>(eye, found, transposed, 8);
    check_against_double<float>(eye, found, {}, four ? 4 : 1);
    check_against_double<double>(eye, found, {}, four ? 4 : 1);
    check_against_double<float>(eye, none, {}, 1);
    check_against_double<double>(eye, none, {}, 1);
  }
  CHECK(with_four == 4);
  CHECK(with_eight == 3);
  CHECK(banded == 2);
}

TEST_CASE("diagonal symmetry is its own inverse and asks for a square picture and lattice") {
  const auto nominal = [](int rows, int cols, const hal::ObjectPlane& plane) {
    hal::EyeGeometry eye = geometry(8, 1.5, 8.0);
    eye.rows = rows;
    eye.columns = cols;
    return seeing(calib::nominal_response(eye, plane).value());
  };
  const Response square = nominal(8, 8, {16, 16, 8, 8, 30});
  const auto transposed = recon::find_diagonal_symmetry(square);
  REQUIRE(transposed.size() == 64);
  for (std::int32_t m = 0; m < 64; ++m) CHECK(transposed[static_cast<std::size_t>(m)] == m % 8 * 8 + m / 8);
  CHECK(recon::find_diagonal_symmetry(nominal(8, 6, {16, 16, 8, 8, 30})).empty());
  CHECK(recon::find_diagonal_symmetry(nominal(8, 8, {16, 12, 8, 8, 30})).empty());
  CHECK(recon::find_diagonal_symmetry(nominal(8, 8, {16, 16, 8, 9, 30})).empty());
}

TEST_CASE("an eye's operator is running sums, a matrix without runs is not") {
  const auto kind_of = [](const Response& a) {
    recon::KeptTables kept;
    return recon::make_operator<float>(a, std::nullopt, kept).value().kind;
  };
  Random random(63);
  const auto nominal = [&](int side, double dphi, const hal::ObjectPlane& plane) {
    return kind_of(seeing(calib::nominal_response(geometry(side, dphi, 60.0), plane).value()));
  };
  CHECK(nominal(24, 4.5, {96, 96, 60, 60, 10}) == recon::OperatorKind::running_sums_diagonal);
  CHECK(nominal(8, 9.0, {96, 96, 60, 60, 10}) == recon::OperatorKind::running_sums_symmetric);  // few rows
  CHECK(nominal(16, 9.0, {32, 48, 60, 60, 10}) == recon::OperatorKind::running_sums_symmetric);
  CHECK(kind_of(random_response(random, 20, Picture{16, 16}, 1.0)) == recon::OperatorKind::dense);
  CHECK(kind_of(random_response(random, 20, Picture{16, 16}, 0.05)) == recon::OperatorKind::csr);
  CHECK(kind_of(random_runs(random, 300, 20, 60)) == recon::OperatorKind::running_sums);
}
