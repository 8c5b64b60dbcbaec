#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <utility>

#include "recon/core/bases/basis.hpp"
#include "recon/core/bases/wavelet.hpp"
#include "recon/setup/basis_tables.hpp"
#include "tests/recon/random_problem.hpp"
#include "tests/recon/reference/reference_solver.hpp"

using namespace compueye;
using namespace compueye::tests;
using recon::BasisKind;

namespace {

constexpr std::array every_basis{BasisKind::identity, BasisKind::dct, BasisKind::haar,
                                 BasisKind::db4,      BasisKind::dft, BasisKind::tv};

/// A basis with the tables it looks at.
template <class T>
struct OwnedBasis {
  OwnedBasis(BasisKind kind, int rows, int cols)
      : dct_rows(recon::make_dct_table<T>(rows)),
        dct_cols(recon::make_dct_table<T>(cols)),
        fourier_rows(recon::make_fourier_table<T>(rows)),
        fourier_cols(recon::make_fourier_table<T>(cols)) {
    const auto r = static_cast<std::size_t>(rows), c = static_cast<std::size_t>(cols);
    psi.kind = kind;
    psi.rows = r;
    psi.cols = c;
    psi.dct = {{r, dct_rows.data()}, {c, dct_cols.data()}};
    psi.fourier = {r, c, fourier_rows.data(), fourier_cols.data()};
    scratch.resize(psi.scratch_size());
  }
  std::vector<T> analyse(const std::vector<T>& x) {
    std::vector<T> out(psi.coefficients());
    recon::core::analyse(psi, x.data(), out.data(), scratch.data());
    return out;
  }
  std::vector<T> synthesise(const std::vector<T>& c) {
    std::vector<T> out(psi.pixels());
    recon::core::synthesise(psi, c.data(), out.data(), scratch.data());
    return out;
  }
  std::vector<T> dct_rows, dct_cols, fourier_rows, fourier_cols, scratch;
  recon::core::Basis<T> psi;
};

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}

}  // namespace

TEST_CASE("every basis is the matrix of its definition, and its synthesis the transpose") {
  Random random(24);
  for (const BasisKind kind : every_basis) {
    for (const auto& size : {std::pair{1, 1}, {1, 8}, {2, 2}, {4, 6}, {5, 7}, {8, 8}, {8, 12}, {16, 16}, {9, 1}}) {
      CAPTURE(static_cast<int>(kind));
      CAPTURE(size.first);
      CAPTURE(size.second);
      OwnedBasis<double> basis(kind, size.first, size.second);
      const Eigen::MatrixXd psi = recon::reference::basis_matrix(kind, size.first, size.second);
      REQUIRE(static_cast<std::size_t>(psi.rows()) == basis.psi.coefficients());
      const auto x = random_vector(random, static_cast<int>(psi.cols()));
      const auto c = random_vector(random, static_cast<int>(psi.rows()));
      const Eigen::VectorXd analysed = psi * Eigen::Map<const Eigen::VectorXd>(x.data(), psi.cols());
      const Eigen::VectorXd synthesised = psi.transpose() * Eigen::Map<const Eigen::VectorXd>(c.data(), psi.rows());
      const auto px = basis.analyse(x), ptc = basis.synthesise(c);
      for (std::size_t k = 0; k < px.size(); ++k) {
        CHECK(std::abs(px[k] - analysed[static_cast<Eigen::Index>(k)]) < 1e-11);
      }
      for (std::size_t k = 0; k < ptc.size(); ++k) {
        CHECK(std::abs(ptc[k] - synthesised[static_cast<Eigen::Index>(k)]) < 1e-11);
      }
    }
  }
}

TEST_CASE("bases pass the dot test and orthonormal ones keep the norm, at full size in both precisions") {
  Random random(25);
  for (const BasisKind kind : every_basis) {
    CAPTURE(static_cast<int>(kind));
    for (const auto& size : {std::pair{160, 160}, {48, 80}, {33, 64}}) {
      OwnedBasis<double> basis(kind, size.first, size.second);
      const auto x = random_vector(random, size.first * size.second);
      const auto c = random_vector(random, static_cast<int>(basis.psi.coefficients()));
      const auto px = basis.analyse(x);
      CHECK(dot(px, c) == doctest::Approx(dot(x, basis.synthesise(c))).epsilon(1e-9));
      if (basis.psi.orthonormal()) CHECK(dot(px, px) == doctest::Approx(dot(x, x)).epsilon(1e-10));
      CHECK(dot(px, px) <= basis.psi.squared_norm() * dot(x, x) * (1.0 + 1e-10));
      OwnedBasis<float> fast(kind, size.first, size.second);
      const auto pxf = fast.analyse(to_float(x));
      for (std::size_t k = 0; k < px.size(); ++k) CHECK(std::abs(static_cast<double>(pxf[k]) - px[k]) < 3e-5);
    }
  }
}

TEST_CASE("wavelets go as deep as the picture allows") {
  CHECK(recon::core::wavelet_levels({recon::core::Wavelet::haar, 160, 160}) == 5);
  CHECK(recon::core::wavelet_levels({recon::core::Wavelet::db4, 160, 160}) == 5);
  CHECK(recon::core::wavelet_levels({recon::core::Wavelet::haar, 16, 16}) == 4);
  CHECK(recon::core::wavelet_levels({recon::core::Wavelet::db4, 16, 16}) == 2);
  CHECK(recon::core::wavelet_levels({recon::core::Wavelet::haar, 15, 16}) == 0);
  CHECK(recon::core::wavelet_levels({recon::core::Wavelet::db4, 4, 64}) == 0);
}

TEST_CASE("the smoothing metric is the inverse of D'D + I") {
  Random random(26);
  for (const auto& size : {std::pair{1, 1}, {1, 5}, {6, 4}, {16, 16}, {30, 50}}) {
    OwnedBasis<double> tv(BasisKind::tv, size.first, size.second);
    const auto x = random_vector(random, size.first * size.second);
    auto image = tv.synthesise(tv.analyse(x));
    for (std::size_t k = 0; k < x.size(); ++k) image[k] += x[k];
    std::vector<double> inverse;
    for (const double e : recon::smoothing_eigenvalues(size.first, size.second)) inverse.push_back(1.0 / e);
    std::vector<double> coefficients(x.size());
    recon::core::apply_inverse<double>({inverse.data(), tv.psi.dct}, image.data(), coefficients.data(),
                                       tv.scratch.data());
    for (std::size_t k = 0; k < x.size(); ++k) CHECK(image[k] == doctest::Approx(x[k]).epsilon(1e-10));
  }
}
