#include "recon/worker_threads.hpp"

#include <doctest/doctest.h>

#include <array>
#include <chrono>
#include <cstring>
#include <numbers>
#include <string>
#include <thread>
#include <vector>

#include "calib/nominal.hpp"
#include "calib/plausible_response.hpp"
#include "recon/option_names.hpp"
#include "recon/setup/basis_list.hpp"
#include "recon/setup/operator_list.hpp"
#include "recon/setup/quantised_response.hpp"
#include "recon/solver_list.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/memory/allocation_counter.hpp"
#include "tests/recon/random_problem.hpp"
#include "tests/recon/solve_frame.hpp"

using namespace compueye;
using namespace compueye::tests;
using recon::BasisKind;
using recon::OperatorKind;
using recon::Response;

namespace {

constexpr int side = 98;  // enough pixels to be shared; 6 full strips of 16 and one that is not
constexpr std::array<int, 3> thread_counts{2, 3, 5};

hal::EyeGeometry eye_of(int ommatidia) {
  hal::EyeGeometry eye;
  eye.rows = eye.columns = ommatidia;
  eye.interommatidial_rad = 1.2 / ommatidia;
  eye.acceptance_rad = std::numbers::pi / 3.0;
  return eye;
}

Response seeing(const Response& a) {
  return a.select_rows(a.seeing_rows());
}
Response nominal(int ommatidia, int rows = side) {
  return seeing(calib::nominal_response(eye_of(ommatidia), {rows, side, 60, 60, 10}).value());
}
Response measured(int ommatidia) {
  return seeing(calib::plausible_response(eye_of(ommatidia), {side, side, 60, 60, 10}, {}, 5).value());
}

template <class T>
std::vector<T> cast(const std::vector<double>& v) {
  std::vector<T> out;
  for (const double each : v) out.push_back(static_cast<T>(each));
  return out;
}

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

template <class T>
struct Applied {
  std::vector<T> forward, adjoint, analysed, synthesised;
};

/// A, A', Psi and Psi' with these workers.
template <class T>
Applied<T> applied_by(recon::core::LinearOperator<T> a, recon::core::Basis<T> psi, const recon::core::Crew& crew) {
  Random random(101);
  a.crew = psi.dct.crew = crew;
  const recon::AlignedWorkspace memory((a.scratch_size() + psi.scratch_size()) * sizeof(T) + 64);
  auto* scratch = reinterpret_cast<T*>(memory.span().data());
  const auto x = cast<T>(random_vector(random, static_cast<int>(a.cols)));
  const auto y = cast<T>(random_vector(random, static_cast<int>(a.rows)));
  const auto c = cast<T>(random_vector(random, static_cast<int>(psi.coefficients())));
  Applied<T> out{std::vector<T>(y.size()), std::vector<T>(x.size(), T(1)), std::vector<T>(c.size()),
                 std::vector<T>(x.size())};
  recon::core::forward(a, x.data(), out.forward.data(), scratch);
  recon::core::adjoint_accumulate(a, y.data(), out.adjoint.data(), scratch);
  recon::core::analyse(psi, x.data(), out.analysed.data(), scratch);
  recon::core::synthesise(psi, c.data(), out.synthesised.data(), scratch);
  return out;
}

template <class T>
void check_operator(const Response& a, int rows, OperatorKind asked, OperatorKind kind, BasisKind basis) {
  recon::KeptTables kept;
  const auto op = recon::make_operator<T>(recon::quantised(a, asked), asked, kept).value();
  CHECK(op.kind == kind);
  const auto psi = recon::make_basis<T>(basis, rows, side, kept);
  const Applied<T> alone = applied_by(op, psi, {});
  for (const int threads : thread_counts) {
    CAPTURE(threads);
    const auto workers = recon::WorkerThreads::start(threads).value();
    const Applied<T> shared = applied_by(op, psi, workers->crew());
    CHECK(same_bits(shared.forward, alone.forward));
    CHECK(same_bits(shared.adjoint, alone.adjoint));
    CHECK(same_bits(shared.analysed, alone.analysed));
    CHECK(same_bits(shared.synthesised, alone.synthesised));
  }
}

SolvedFrame solved_by(int threads, const Response& a, const recon::Objective& objective, recon::Plan plan) {
  plan.threads = threads;
  const auto made = recon::Reconstructor::create(a, objective, plan);
  REQUIRE(made.has_value());
  CHECK(made->plan().threads == threads);
  Random random(102);
  std::vector<float> weights(static_cast<std::size_t>(a.rows()), 1.0F);
  weights[1] = 0.0F;
  weights[3] = 0.5F;
  return solve_frame(*made, to_float(random_vector(random, a.rows(), 1.0, 200.0)), weights);
}

void check_solver(const Response& a, const recon::Objective& objective, const recon::Plan& plan) {
  const SolvedFrame alone = solved_by(1, a, objective, plan);
  CHECK(alone.info.health != recon::Health::invalid);
  for (const int threads : thread_counts) {
    CAPTURE(threads);
    const SolvedFrame shared = solved_by(threads, a, objective, plan);
    CHECK(same_bits(shared.x, alone.x));
    CHECK(shared.info.objective == alone.info.objective);
    CHECK(shared.info.dual_residual == alone.info.dual_residual);
    CHECK(shared.info.duality_gap == alone.info.duality_gap);
  }
}

}  // namespace

TEST_CASE("every operator and basis has the same bits with one, two, three and five threads") {
  const Response square = nominal(32), wide = nominal(8, side + 2), uneven = measured(6);
  check_operator<float>(square, side, OperatorKind::running_sums, OperatorKind::running_sums_diagonal, BasisKind::dct);
  check_operator<double>(square, side, OperatorKind::running_sums, OperatorKind::running_sums_diagonal, BasisKind::tv);
  check_operator<float>(wide, side + 2, OperatorKind::running_sums, OperatorKind::running_sums_symmetric,
                        BasisKind::tv);
  const Response some = square.select_rows(std::vector<std::int32_t>{3, 7, 20, 21, 40});
  check_operator<float>(some, side, OperatorKind::running_sums, OperatorKind::running_sums, BasisKind::identity);
  for (const OperatorKind kind :
       {OperatorKind::dense, OperatorKind::csr, OperatorKind::dense_runs, OperatorKind::dense_runs_bf16,
        OperatorKind::dense_runs_int8, OperatorKind::wavelet_runs}) {
    CAPTURE(recon::name(kind));
    check_operator<float>(uneven, side, kind, kind, BasisKind::haar);
    check_operator<double>(uneven, side, kind, kind, BasisKind::dft);
  }
}

TEST_CASE("every solver and basis has the same bits with one, two, three and five threads") {
  const Response a = measured(4);
  int compared = 0;
  for (const auto& solver : recon::solver_names()) {
    for (const auto& basis : recon::basis_names()) {
      CAPTURE(solver.name);
      CAPTURE(basis.name);
      recon::Objective objective;
      objective.basis = basis.kind;
      objective.lambda = 0.05;
      recon::Plan plan;
      plan.solver = solver.kind;
      plan.iterations = 4;
      plan.max_reweighted = 2;
      plan.measure_gap = true;
      if (!recon::supports(solver.kind, basis.kind, recon::ConstraintKind::none)) continue;
      check_solver(a, objective, plan);
      ++compared;
    }
  }
  CHECK(compared > 30);
}

TEST_CASE("a symmetric eye's inverse by classes and reweighting have the same bits with any number of threads") {
  recon::Objective objective;
  objective.constraint = recon::ConstraintKind::nonnegative;
  objective.lambda = 0.05;
  recon::Plan plan;
  plan.iterations = 4;
  for (const BasisKind basis : {BasisKind::identity, BasisKind::dct, BasisKind::tv}) {
    CAPTURE(recon::name(basis));
    objective.basis = basis;
    check_solver(nominal(12), objective, plan);
  }
  plan.solver = recon::solver_named("pdhg");
  check_solver(nominal(12), objective, plan);
  plan.solver = recon::solver_named("admm");
  objective.basis = BasisKind::identity;
  plan.l1_reweighting = 0.1;
  check_solver(nominal(12), objective, plan);
}

TEST_CASE("frames solved at once by several callers share the workers or do without") {
  recon::Objective objective;
  objective.basis = BasisKind::dct;
  objective.lambda = 0.05;
  recon::Plan plan;
  plan.iterations = 10;
  plan.threads = 3;
  const Response a = measured(4);
  const auto solver = recon::Reconstructor::create(a, objective, plan).value();
  Random random(103);
  const auto y = to_float(random_vector(random, a.rows(), 1.0, 200.0));
  const SolvedFrame expected = solve_frame(solver, y);
  std::vector<std::vector<SolvedFrame>> solved(3);
  std::vector<std::thread> callers;
  for (auto& mine : solved) {
    callers.emplace_back([&solver, &y, &mine] {
      for (int k = 0; k < 4; ++k) mine.push_back(solve_frame(solver, y));
    });
  }
  for (std::thread& caller : callers) caller.join();
  for (const auto& mine : solved) {
    for (const SolvedFrame& frame : mine) CHECK(same_bits(frame.x, expected.x));
  }
}

TEST_CASE("sharing a frame does not touch the heap, after a rest neither") {
  recon::Objective objective;
  objective.basis = BasisKind::dct;
  objective.lambda = 0.05;
  recon::Plan plan;
  plan.iterations = 3;
  plan.threads = 3;
  const Response a = measured(4);
  const auto solver = recon::Reconstructor::create(a, objective, plan).value();
  const recon::AlignedWorkspace workspace(solver.required_bytes());
  std::vector<float> y(static_cast<std::size_t>(a.rows()), 1.0F), x(side * side);
  const HeapUse before = heap_use_of_this_thread();
  for (int k = 0; k < 3; ++k) {
    CHECK(solver.solve(y, {}, workspace.span(), x).health != recon::Health::invalid);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));  // so that they sleep
  }
  const HeapUse used = heap_use_of_this_thread() - before;
  CHECK(used.calls() == 0);
}

TEST_CASE("a number of threads out of range is refused") {
  recon::Objective objective;
  recon::Plan plan;
  for (const int threads : {0, -1, recon::WorkerThreads::most + 1}) {
    plan.threads = threads;
    test::check_error(recon::Reconstructor::create(measured(4), objective, plan), hal::ErrorCode::out_of_range,
                      "threads", {std::to_string(threads), "1", std::to_string(recon::WorkerThreads::most)});
  }
}
