// What holds of every matrix, number and problem: RapidCheck draws them, and shrinks what breaks a property.

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>

#include "recon/core/parts/proximal.hpp"
#include "recon/option_names.hpp"
#include "recon/setup/basis_list.hpp"
#include "recon/setup/operator_list.hpp"
#include "recon/setup/quantised_response.hpp"
#include "recon/solver_list.hpp"
#include "studies/stability/hard_responses.hpp"
#include "tests/hard/hard_run.hpp"
#include "tests/property/generated_problem.hpp"
#include "tests/recon/relative_difference.hpp"

using namespace compueye;
using namespace compueye::tests;
using firmware::HardProblem;

namespace {

double dot(const auto& a, const auto& b) {
  double sum = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += static_cast<double>(a[k]) * static_cast<double>(b[k]);
  return sum;
}

/// <A x, u> = <x, A'u>, and A x is what the response itself says, in one form of A.
template <class T>
void check_operator(const recon::Response& a, recon::OperatorKind kind) {
  const recon::Response stored = recon::is_lossy(kind) ? recon::quantised(a, kind) : a;
  RC_PRE(!stored.seeing_rows().empty());
  const recon::Response seeing = stored.select_rows(stored.seeing_rows());
  recon::KeptTables kept;
  const auto op = recon::make_operator<T>(seeing, kind, kept);
  if (!op) return;  // does not fit this matrix, and says so
  std::vector<T> x(static_cast<std::size_t>(a.cols())), u(static_cast<std::size_t>(seeing.rows())), forward(u.size()),
      back(x.size());
  const auto drawn_x = eighths(x.size()), drawn_u = eighths(u.size());
  std::copy(drawn_x.begin(), drawn_x.end(), x.begin());
  std::copy(drawn_u.begin(), drawn_u.end(), u.begin());
  std::vector<T> scratch(op->scratch_size());
  recon::core::forward(*op, x.data(), forward.data(), scratch.data());
  recon::core::adjoint_accumulate(*op, u.data(), back.data(), scratch.data());
  const double size = std::sqrt(seeing.squared_norm() * dot(x, x) * dot(u, u));
  const double rounding = 64.0 * static_cast<double>(std::numeric_limits<T>::epsilon());
  RC_ASSERT(std::abs(dot(forward, u) - dot(x, back)) <= rounding * size);
  std::vector<double> right(u.size());
  seeing.forward(drawn_x, right);
  for (std::size_t m = 0; m < right.size(); ++m) {
    RC_ASSERT(std::abs(static_cast<double>(forward[m]) - right[m]) <=
              rounding * std::sqrt(seeing.squared_norm() * dot(x, x)));
  }
}

HardSetting some_setting() {
  HardRow every;
  every.hard.name = "every";
  static const std::vector<HardSetting> settings = settings_of(every);
  return settings[*rc::gen::inRange<std::size_t>(0, settings.size())];
}

HardRow row_of(int iterations) {
  HardRow row;
  row.hard.lambda_share = 1.0 / 64.0;
  row.iterations = iterations;
  return row;
}

bool same_bits(const HardRun& a, const HardRun& b) {
  return a.refused.has_value() == b.refused.has_value() && a.x == b.x && a.info.health == b.info.health &&
         a.info.objective == b.info.objective;
}

}  // namespace

TEST_CASE("every form of A and its adjoint belong together") {
  for (const recon::OperatorRow& row : recon::operators()) {
    CHECK(rc::check(std::string("the dot test of ") + std::string(row.name), [&] {
      const recon::Response a = some_response();
      check_operator<float>(a, row.kind);
      if (!row.lossy) check_operator<double>(a, row.kind);
    }));
  }
}

TEST_CASE("every basis gives back what it took, and keeps its size") {
  for (const auto& basis : recon::basis_names()) {
    CHECK(rc::check(std::string("Psi of ") + std::string(basis.name), [&] {
      const int rows = *rc::gen::inRange(1, 20), cols = *rc::gen::inRange(1, 20);
      recon::KeptTables kept;
      const auto psi = recon::make_basis<double>(basis.kind, rows, cols, kept);
      const auto x = eighths(psi.pixels()), q = eighths(psi.coefficients());
      std::vector<double> c(q.size()), back(x.size()), scratch(psi.scratch_size());
      recon::core::analyse(psi, x.data(), c.data(), scratch.data());
      recon::core::synthesise(psi, q.data(), back.data(), scratch.data());
      const double rounding = 1e-11 * (1.0 + dot(x, x) + dot(q, q));  // db4's filter is known to 1e-12
      RC_ASSERT(std::abs(dot(c, q) - dot(x, back)) <= rounding);      // the adjoint
      if (!psi.orthonormal()) return;
      recon::core::synthesise(psi, c.data(), back.data(), scratch.data());
      for (std::size_t k = 0; k < x.size(); ++k) RC_ASSERT(std::abs(back[k] - x[k]) <= rounding);
      RC_ASSERT(std::abs(dot(c, c) - dot(x, x)) <= rounding);
    }));
  }
}

TEST_CASE("the proximal map of l1 and a box is Moreau's") {
  const auto any = [] { return *rc::gen::inRange(-4096, 4097) / 64.0; };
  CHECK(rc::check("t = prox(t) + clip(t) without a box", [&] {
    const double t = any(), threshold = std::abs(any());
    RC_ASSERT(recon::core::prox_l1_box(t, threshold, -1e30, 1e30) + std::clamp(t, -threshold, threshold) == t);
    RC_ASSERT(recon::core::within(t, threshold) == std::clamp(t, -threshold, threshold));
  }));
  CHECK(rc::check("it is firmly nonexpansive, and in the box", [&] {
    const double a = any(), b = any(), threshold = std::abs(any()), lo = any(), hi = lo + std::abs(any());
    const double p = recon::core::prox_l1_box(a, threshold, lo, hi), q = recon::core::prox_l1_box(b, threshold, lo, hi);
    RC_ASSERT((p - q) * (p - q) <= (p - q) * (a - b));
    RC_ASSERT(p >= lo);
    RC_ASSERT(p <= hi);
  }));
  CHECK(rc::check("nothing in the box costs less", [&] {
    const double t = any(), threshold = std::abs(any()), lo = any(), hi = lo + std::abs(any());
    const double other = std::clamp(any(), lo, hi);
    const auto cost = [&](double x) { return 0.5 * (x - t) * (x - t) + threshold * std::abs(x); };
    RC_ASSERT(cost(recon::core::prox_l1_box(t, threshold, lo, hi)) <= cost(other));
  }));
}

TEST_CASE("every solver gives a finite picture of every problem, or says why not") {
  CHECK(rc::check("finite", [] {
    const HardProblem problem = some_problem();
    const HardRun done = run(row_of(*rc::gen::inRange(1, 60)), some_setting(), problem);
    RC_PRE(!done.refused);
    RC_ASSERT(std::all_of(done.x.begin(), done.x.end(), [](float v) { return std::isfinite(v); }));
    RC_ASSERT(std::isfinite(done.info.objective));
    RC_ASSERT(done.info.health != recon::Health::invalid);
  }));
}

TEST_CASE("of every solver a power of two changes nothing but the unit") {
  CHECK(rc::check("scaling", [] {
    const HardProblem problem = some_problem();
    const HardSetting setting = some_setting();
    const HardRow row = row_of(20);
    const int of_a = *rc::gen::inRange(-3, 4), of_y = *rc::gen::inRange(-3, 4);
    HardProblem scaled = problem;
    scaled.a = firmware::scaled(problem.a, std::ldexp(1.0, of_a));
    for (float& value : scaled.y) value = std::ldexp(value, of_y);
    recon::Objective objective = objective_of(row, setting, scaled);
    objective.hi = std::ldexp(objective.hi, of_y - of_a);
    const HardRun plain = run(row, setting, problem), done = run(objective, plan_of(row, setting, scaled), scaled);
    RC_ASSERT(plain.refused.has_value() == done.refused.has_value());
    for (std::size_t n = 0; n < plain.x.size(); ++n) RC_ASSERT(std::ldexp(done.x[n], of_a - of_y) == plain.x[n]);
  }));
}

TEST_CASE("of every solver a masked sample may be anything") {
  CHECK(rc::check("masking", [] {
    HardProblem problem = some_problem();
    const auto at = *rc::gen::inRange<std::size_t>(0, problem.y.size());
    problem.weights[at] = 0.0F;
    HardProblem other = problem;
    other.y[at] = *rc::gen::element(0.0F, 1e30F, -1e-40F, std::numeric_limits<float>::quiet_NaN());
    const HardSetting setting = some_setting();
    RC_ASSERT(same_bits(run(row_of(15), setting, problem), run(row_of(15), setting, other)));
  }));
}

TEST_CASE("of every solver the order of the rows is nothing but rounding") {
  CHECK(rc::check("permuting", [] {
    const HardProblem problem = some_problem();
    HardSetting setting = some_setting();
    setting.precision = recon::Precision::f64;
    RC_PRE(setting.solver->minimises);  // omp chooses between atoms that are equally good
    std::vector<std::int32_t> order(problem.y.size());
    std::iota(order.begin(), order.end(), 0);
    std::reverse(order.begin(), order.end());
    HardProblem turned = problem;
    turned.a = problem.a.select_rows(order);
    std::reverse(turned.y.begin(), turned.y.end());
    std::reverse(turned.weights.begin(), turned.weights.end());
    const HardRun plain = run(row_of(600), setting, problem), done = run(row_of(600), setting, turned);
    RC_ASSERT(plain.refused.has_value() == done.refused.has_value());
    RC_PRE(!plain.refused && plain.info.health == recon::Health::converged);
    RC_ASSERT(std::abs(plain.info.objective - done.info.objective) <= 2e-3 * plain.info.objective + 1e-12);
  }));
}
