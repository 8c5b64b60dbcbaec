#include <doctest/doctest.h>

#include <cmath>

#include "recon/core/bases/dct.hpp"
#include "recon/setup/basis_tables.hpp"
#include "tests/recon/random_problem.hpp"

using namespace compueye;
using namespace compueye::tests;
namespace core = recon::core;

namespace {

/// A picture's dual of ||Psi x||_1, moved in one pass with the transforms and by one after the other.
template <class T>
void check_ascent(int height, int width) {
  CAPTURE(height);
  CAPTURE(width);
  const auto rows = static_cast<std::size_t>(height), cols = static_cast<std::size_t>(width), n = rows * cols;
  const std::vector<T> row_table = recon::make_dct_table<T>(height), col_table = recon::make_dct_table<T>(width);
  core::Dct2d<T> psi;
  psi.rows = {rows, row_table.data()};
  psi.cols = {cols, col_table.data()};
  std::vector<T> scratch(core::dct_scratch_size(rows, cols)), coefficients(n), expected(n), picture(n);
  std::vector<T> dual(n, T(0)), strips(core::dct_strips_size(rows, cols), T(0)), in_place = strips;
  const core::Ascent<T> ascent{T(0.7), T(0.5), T(1.5)};
  Random random(31);
  for (int step = 0; step < 3; ++step) {  // the dual of one is where the next begins
    std::vector<T> x;
    for (const double v : random_vector(random, height * width)) x.push_back(static_cast<T>(v));
    core::dct_forward(psi, x.data(), coefficients.data(), scratch.data());
    core::ascend(coefficients.data(), ascent, dual.data(), n);
    core::dct_inverse(psi, dual.data(), expected.data(), scratch.data());
    core::dct_ascend(psi, ascent, x.data(), strips.data(), picture.data(), scratch.data());
    CHECK(picture == expected);
    // In place, as the last iteration does it.
    core::dct_ascend(psi, ascent, x.data(), in_place.data(), x.data(), scratch.data());
    CHECK(x == expected);
    for (std::size_t r = 0; r < rows; ++r) {
      for (std::size_t c = 0; c < cols; ++c) {
        CHECK(strips[core::dct_strip_element(r, c, cols)] == dual[r * cols + c]);
      }
    }
  }
}

}  // namespace

TEST_CASE("a dual in strips moves as one in its picture's order, bit for bit") {
  for (const auto& [rows, cols] : {std::pair{1, 1}, {5, 3}, {16, 16}, {17, 24}, {24, 17}, {40, 32}, {33, 50}}) {
    check_ascent<float>(rows, cols);
    check_ascent<double>(rows, cols);
  }
}

TEST_CASE("a dual that has moved far enough stays within its bound unless it is relaxed beyond") {
  const core::Ascent<float> plain{10.0F, 0.5F, 1.0F}, relaxed{10.0F, 0.5F, 1.5F};
  CHECK(plain.moved(0.0F, 1.0F) == 0.5F);
  CHECK(plain.moved(0.0F, -1.0F) == -0.5F);
  CHECK(plain.moved(0.25F, 0.01F) == doctest::Approx(0.35F));
  CHECK(relaxed.moved(0.0F, 1.0F) == 0.75F);
  CHECK_FALSE(std::isnan(plain.moved(0.0F, std::nanf(""))));  // a dual recovers; the frame is judged by its picture
  CHECK(plain.moved(1e-25F, 0.0F) == 0.0F);
}
