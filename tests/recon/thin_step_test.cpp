#include "recon/core/parts/thin_step.hpp"

#include <doctest/doctest.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <new>
#include <vector>

#include "bench/eyes.hpp"
#include "calib/nominal.hpp"
#include "recon/setup/mirror_symmetry.hpp"
#include "recon/setup/thin_step_tables.hpp"
#include "tests/recon/dense_matrix.hpp"
#include "tests/recon/random_problem.hpp"

using namespace compueye;
using namespace compueye::tests;

namespace {

recon::Response small_eye() {
  const bench::Eye eye = bench::eye_8x8();
  return calib::nominal_response(eye.geometry, eye.plane).value();
}

template <class T>
struct Aligned {
  explicit Aligned(std::size_t size)
      : values(static_cast<T*>(::operator new (size * sizeof(T), std::align_val_t{64}))) {
    for (std::size_t k = 0; k < size; ++k) values[k] = T(0);
  }
  Aligned(const Aligned&) = delete;
  Aligned& operator=(const Aligned&) = delete;
  ~Aligned() { ::operator delete (values, std::align_val_t{64}); }
  T* values;
};

/// The step's v for one level, in the picture's own order.
template <class T>
std::vector<T> stepped(const recon::core::ThinStep<T>& step, std::size_t level, const std::vector<T>& y,
                       const std::vector<T>& v) {
  const Aligned<T> samples(step.sample_size()), residual(step.sample_size()), picture(step.cols);
  recon::core::turn_samples(step, y.data(), samples.values, residual.values);
  for (std::size_t k = 0; k < step.cols; ++k) {
    picture.values[k] = v[step.lanes == 1 ? k : static_cast<std::size_t>(step.pixel[k])];
  }
  recon::core::apply(step, level, samples.values, picture.values, residual.values);
  std::vector<T> x(step.cols);
  recon::core::restore_picture(step, picture.values, x.data());
  return x;
}

template <class T>
void check_step(const recon::Response& a, std::size_t lanes, double tolerance) {
  const recon::ParityClasses classes(a.rows(), recon::find_mirror_symmetry(a));
  const std::vector<double> penalties{0.9, 0.05, 7.0};
  const auto tables = recon::thin_step_tables<T>(a, classes, penalties);
  REQUIRE(tables.view.rows > 0);
  REQUIRE(tables.view.lanes == lanes);
  const Eigen::MatrixXd matrix = dense_matrix(a);
  Random random(3);
  const std::vector<double> v = random_vector(random, a.cols()), y = random_vector(random, a.rows(), 0.0, 30.0);
  const Eigen::Map<const Eigen::VectorXd> before(v.data(), a.cols()), samples(y.data(), a.rows());
  for (std::size_t level = 0; level < penalties.size(); ++level) {
    Eigen::MatrixXd normal = matrix * matrix.transpose();
    normal.diagonal().array() += penalties[level];
    const Eigen::VectorXd expected =
        before + matrix.transpose() * normal.partialPivLu().solve(samples - matrix * before);
    const auto x = stepped<T>(tables.view, level, {y.begin(), y.end()}, {v.begin(), v.end()});
    double worst = 0.0;
    for (Eigen::Index k = 0; k < expected.size(); ++k) {
      worst = std::max(worst, std::abs(static_cast<double>(x[static_cast<std::size_t>(k)]) - expected[k]));
    }
    CHECK(worst <= tolerance * expected.lpNorm<Eigen::Infinity>());
  }
}

}  // namespace

TEST_CASE("the thin step is the quadratic step for every penalty, by parity classes and whole") {
  const recon::Response folded = small_eye();
  Random random(12);
  const recon::Response whole = random_response(random, 24, Picture{8, 16}, 0.6);
  check_step<double>(folded, 4, 1e-12);
  check_step<double>(whole, 1, 1e-12);
  // Rounding of entries and sums, times ||y - A v|| / (s + rho) where s is least: 1e3 roundings of a float.
  check_step<float>(folded, 4, 6e-5);
  check_step<float>(whole, 1, 6e-5);
}

TEST_CASE("there is no thin step where pixels do not fill vectors or A is large") {
  Random random(4);
  for (const auto& [rows, cols, image_rows] : {std::array{10, 100, 10}, std::array{300, 1024, 32}}) {
    const recon::Response a = random_response(random, rows, Picture{image_rows, cols / image_rows}, 0.5);
    const recon::ParityClasses classes(a.rows(), recon::find_mirror_symmetry(a));
    CHECK(recon::thin_step_tables<float>(a, classes, {1.0}).view.rows == 0);
  }
}
