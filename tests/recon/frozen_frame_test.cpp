#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <numbers>
#include <set>
#include <span>
#include <vector>

#include "calib/nominal.hpp"
#include "recon/core/frame/frozen_frame.hpp"
#include "tests/golden/frozen_solvers.hpp"
#include "tests/recon/every_setting.hpp"
#include "tests/recon/solve_frame.hpp"
#include "tests/recon/solver_problems.hpp"
#include "tests/sanitized.hpp"

using namespace compueye;
using namespace compueye::tests;

namespace {

recon::Response nominal(int side, double acceptance_deg, const hal::ObjectPlane& plane) {
  constexpr double deg = std::numbers::pi / 180.0;
  hal::EyeGeometry eye;
  eye.rows = eye.columns = side;
  eye.interommatidial_rad = 12.0 / side * deg;
  eye.acceptance_rad = acceptance_deg * deg;
  return calib::nominal_response(eye, plane).value();
}

/// Every form of A: running sums with symmetry and without, dense, sparse.
std::vector<SolverProblem> problems() {
  std::vector<SolverProblem> all;
  all.push_back({"four mirrored rows", nominal(8, 8.0, {16, 16, 8.0, 8.0, 30.0})});
  all.push_back({"an odd side", nominal(12, 40.0, {41, 44, 20.0, 20.0, 30.0})});
  Random random(72);
  all.push_back({"few entries", random_response(random, 12, Picture{10, 10}, 0.05)});
  for (SolverProblem& each : solver_problems()) {
    if (each.name == "dense wide" || each.name == "sparse wide" || each.name == "zero rows") all.push_back(each);
  }
  return all;
}

struct Sample {
  std::vector<float> y, weights;
};

Sample sample_for(const recon::Reconstructor& solver) {
  const auto channels = static_cast<std::size_t>(solver.channels());
  Sample sample{std::vector<float>(channels), std::vector<float>(channels, 1.0F)};
  for (std::size_t m = 0; m < channels; ++m) sample.y[m] = static_cast<float>((m * 37) % 64) / 8.0F;
  if (solver.plan().max_reweighted > 0) sample.weights[1] = 0.25F;
  return sample;
}

std::vector<std::byte> frozen(const recon::Reconstructor& solver, const Sample& sample) {
  const SolvedFrame solved = solve_frame(solver, sample.y, sample.weights);
  return solver.freeze({sample.y.data(), sample.weights.data(), solved.x.data(), solved.info.objective});
}

/// The bytes where a program that thaws them would have put them.
struct Copy {
  explicit Copy(const std::vector<std::byte>& bytes) : memory(bytes.size()) {
    std::copy(bytes.begin(), bytes.end(), memory.span().begin());
  }
  recon::core::Thawed thaw() { return recon::core::thaw(memory.span().data(), memory.span().size(), frame); }
  template <class Use>
  recon::core::Thawed thaw_any(const Use& use) {
    return golden::thaw_any(memory.span().data(), memory.span().size(), use);
  }

  recon::AlignedWorkspace memory;
  recon::core::FrozenFrame<recon::core::AdmmProblem<float>> frame;
};

template <class Problem>
void check_same_bits(const recon::core::FrozenFrame<Problem>& frame, const recon::Reconstructor& frozen) {
  CHECK(Problem::method == frozen.plan().solver->name);
  CHECK(Problem::solver.bytes(frame.problem) == frozen.required_bytes());
  const recon::AlignedWorkspace workspace(frozen.required_bytes());
  std::vector<float> x(frame.problem.pixels());
  const auto info =
      Problem::solver.solve(frame.problem, frame.samples.y, frame.samples.weights, workspace.span().data(), x.data());
  CHECK(recon::core::differing_pixels(frame.samples.picture, x.data(), x.size()) == 0);
  CHECK(info.objective == frame.samples.objective);
  CHECK(info.health != recon::Health::invalid);
}

recon::Reconstructor small_solver() {
  recon::Objective objective;
  objective.basis = recon::BasisKind::dct;
  objective.constraint = recon::ConstraintKind::box;
  objective.lambda = 0.1;
  recon::Plan plan;
  plan.iterations = 5;
  const SolverProblem problem = problems().front();
  return recon::Reconstructor::create(problem.a, objective, plan).value();
}

}  // namespace

TEST_CASE("every setting gives the same bits again from its frozen bytes alone") {
  int solved = 0, of_large = 0;
  std::set<recon::OperatorKind> kinds;
  for (const SolverProblem& problem : problems()) {
    for (const SolverSetting& setting : every_setting()) {
      if (setting.plan.precision != recon::Precision::f32) continue;
      if (test::sanitized && problem.a.cols() > 1000 && ++of_large % 8 != 0) continue;
      CAPTURE(problem.name);
      CAPTURE(setting.name);
      recon::Plan plan = setting.plan;
      if (test::sanitized) plan.iterations = std::min(plan.iterations, 12);
      const auto solver = recon::Reconstructor::create(problem.a, setting.objective, plan);
      REQUIRE(solver);
      Copy copy(frozen(*solver, sample_for(*solver)));
      const auto thawed = copy.thaw_any([&](const auto& frame) {
        check_same_bits(frame, *solver);
        kinds.insert(frame.problem.a.kind);
      });
      REQUIRE(thawed == recon::core::Thawed::ready);
      ++solved;
    }
  }
  CHECK(solved > 100);
  CHECK(kinds.size() >= 4);
}

TEST_CASE("forms of A that have to be asked for give the same bits again from their frozen bytes") {
  for (const recon::OperatorKind kind : {recon::OperatorKind::dense_runs, recon::OperatorKind::dense_runs_bf16,
                                         recon::OperatorKind::dense_runs_int8, recon::OperatorKind::wavelet_runs}) {
    CAPTURE(static_cast<int>(kind));
    recon::Objective objective;
    objective.lambda = 0.1;
    recon::Plan plan;
    plan.iterations = 5;
    plan.op = kind;
    const auto solver = recon::Reconstructor::create(nominal(5, 40.0, {41, 44, 20.0, 20.0, 30.0}), objective, plan);
    REQUIRE(solver);
    CHECK(solver->operating_point().op == kind);
    Copy copy(frozen(*solver, sample_for(*solver)));
    REQUIRE(copy.thaw_any([&](const auto& frame) { check_same_bits(frame, *solver); }) == recon::core::Thawed::ready);
  }
}

TEST_CASE("a bound that is not there survives freezing") {
  recon::Objective objective;
  objective.constraint = recon::ConstraintKind::nonnegative;
  const SolverProblem problem = problems().front();
  const auto solver = recon::Reconstructor::create(problem.a, objective, {}).value();
  Copy copy(frozen(solver, sample_for(solver)));
  REQUIRE(copy.thaw() == recon::core::Thawed::ready);
  CHECK(copy.frame.problem.lo == 0.0F);
  CHECK(copy.frame.problem.hi == static_cast<float>(recon::core::no_bound));
  CHECK(copy.frame.problem.constrained);
  CHECK(!copy.frame.problem.bounded);
}

TEST_CASE("a pixel of other bits is counted, though it may compare equal") {
  const auto solver = small_solver();
  Copy copy(frozen(solver, sample_for(solver)));
  REQUIRE(copy.thaw() == recon::core::Thawed::ready);
  const float* picture = copy.frame.samples.picture;
  std::vector<float> x(picture, picture + copy.frame.problem.pixels());
  x[3] = 2.0F;
  CHECK(recon::core::differing_pixels(picture, x.data(), x.size()) == 1);
  for (float& v : x) v = v == 0.0F ? -0.0F : v;
  CHECK(recon::core::differing_pixels(picture, x.data(), x.size()) > 1);
}

TEST_CASE("bytes that are no whole frozen frame of this version are refused") {
  const auto solver = small_solver();
  const std::vector<std::byte> whole = frozen(solver, sample_for(solver));
  const auto thawed = [](std::vector<std::byte> bytes) { return Copy(bytes).thaw(); };
  CHECK(thawed(whole) == recon::core::Thawed::ready);
  CHECK(thawed({}) == recon::core::Thawed::foreign);
  auto foreign = whole;
  foreign[0] = std::byte{0};
  CHECK(thawed(foreign) == recon::core::Thawed::foreign);
  auto newer = whole;
  newer[8] = std::byte{99};
  CHECK(thawed(newer) == recon::core::Thawed::other_version);
  auto of_another = whole;
  of_another[24] = std::byte{'p'};
  CHECK(thawed(of_another) == recon::core::Thawed::other_method);
  auto longer = whole;
  longer.resize(whole.size() + 64);
  CHECK(thawed(longer) == recon::core::Thawed::damaged);
}

TEST_CASE("frozen bytes cut short anywhere are refused, their size said right or not") {
  const auto solver = small_solver();
  const std::vector<std::byte> whole = frozen(solver, sample_for(solver));
  for (std::size_t size = 24; size < whole.size(); size += 8) {
    auto cut = std::vector<std::byte>(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    CHECK(Copy(cut).thaw() == recon::core::Thawed::damaged);
    const std::uint64_t said = size;
    std::memcpy(cut.data() + 16, &said, sizeof said);
    CHECK(Copy(cut).thaw() == recon::core::Thawed::damaged);
  }
}
