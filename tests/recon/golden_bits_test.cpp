#include <doctest/doctest.h>

#include <cstdint>
#include <cstring>
#include <vector>

#include "recon/reconstructor.hpp"
#include "recon/solver_list.hpp"
#include "tests/recon/solve_frame.hpp"

using namespace compueye;
using namespace compueye::tests;

namespace {

/// FNV-1a over the bits, so that a golden picture is one number in this file.
std::uint64_t fingerprint(const std::vector<float>& x) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const float v : x) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &v, sizeof bits);
    for (int shift = 0; shift < 32; shift += 8) hash = (hash ^ ((bits >> shift) & 0xFFU)) * 1099511628211ULL;
  }
  return hash;
}

/// Integers only, so that every platform starts from the same bits.
recon::Response golden_response(int rows, int cols, std::uint32_t share) {
  std::uint32_t state = 12345;
  std::vector<double> values;
  for (int k = 0; k < rows * cols; ++k) {
    state = state * 1664525U + 1013904223U;
    values.push_back((state >> 24) < share ? static_cast<double>((state >> 8) & 0xFFU) / 256.0 : 0.0);
  }
  return recon::Response::from_dense(rows, cols, values).value();
}

std::uint64_t golden_frame(recon::BasisKind basis, recon::ConstraintKind constraint, std::uint32_t share, int rows = 12,
                           int cols = 20, recon::SolverKind kind = recon::solver_named("admm")) {
  recon::Objective objective;
  objective.basis = basis;
  objective.constraint = constraint;
  objective.lambda = 0.125;
  recon::Plan plan;
  plan.solver = kind;
  plan.iterations = 40;
  plan.rho = 0.5;
  const auto solver = recon::Reconstructor::create(
                          golden_response(64, rows * cols, share).with_image(rows, cols).value(), objective, plan)
                          .value();
  std::vector<float> y(64), weights(64, 1.0F);
  for (std::size_t m = 0; m < 64; ++m) y[m] = static_cast<float>((m * 37) % 64) / 8.0F;
  weights[10] = 0.0F;
  weights[50] = 0.25F;
  return fingerprint(solve_frame(solver, y, weights).x);
}

}  // namespace

// The same numbers must come out of every build type, compiler flag set and processor. A change here is a change of
// the arithmetic of the frame path: make it on purpose, and say so in the commit.
TEST_CASE("golden bits") {
  CHECK(golden_frame(recon::BasisKind::identity, recon::ConstraintKind::nonnegative, 60) == 671868210751829915ULL);
  CHECK(golden_frame(recon::BasisKind::identity, recon::ConstraintKind::none, 26) == 14162974625954095092ULL);
  CHECK(golden_frame(recon::BasisKind::dct, recon::ConstraintKind::none, 255) == 18417467350881540013ULL);
  CHECK(golden_frame(recon::BasisKind::dct, recon::ConstraintKind::box, 26) == 5664338109102824947ULL);
  // Sides whose DCT has rotated levels.
  CHECK(golden_frame(recon::BasisKind::dct, recon::ConstraintKind::box, 60, 24, 40) == 11741915941537642681ULL);
  CHECK(golden_frame(recon::BasisKind::tv, recon::ConstraintKind::nonnegative, 60, 32, 24) == 1180061221046381251ULL);
  CHECK(golden_frame(recon::BasisKind::dct, recon::ConstraintKind::box, 60, 24, 40, recon::solver_named("pdhg")) ==
        3916601505770877210ULL);
}
