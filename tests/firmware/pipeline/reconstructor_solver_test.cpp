#include "firmware/pipeline/reconstructor_solver.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "recon/aligned_workspace.hpp"
#include "tests/memory/allocation_counter.hpp"

using namespace compueye;

namespace {

constexpr int rows = 5;
constexpr int cols = 6;
constexpr int solved_channels = 12;

recon::Reconstructor make_reconstructor() {
  std::vector<double> values;
  for (int m = 0; m < solved_channels; ++m) {
    for (int n = 0; n < rows * cols; ++n) values.push_back((m * 7 + n * 3) % 11 < 5 ? 0.125 * ((m + n) % 8) : 0.0);
  }
  recon::Objective objective;
  objective.basis = recon::BasisKind::dct;
  objective.constraint = recon::ConstraintKind::box;
  objective.lambda = 0.05;
  recon::Plan plan;
  plan.max_reweighted = 2;
  const auto response =
      recon::Response::from_dense(solved_channels, rows * cols, values).value().with_image(rows, cols).value();
  return recon::Reconstructor::create(response, objective, plan).value();
}

std::vector<float> samples(float level) {
  std::vector<float> y;
  for (int m = 0; m < solved_channels; ++m) y.push_back(level * static_cast<float>(m % 5));
  return y;
}

}  // namespace

TEST_CASE("the pipeline's solver gives the reconstructor's picture, frame after frame and without the heap") {
  const recon::Reconstructor reconstructor = make_reconstructor();
  firmware::ReconstructorSolver solver(reconstructor);
  CHECK(solver.channels() == solved_channels);
  CHECK(solver.format().rows == rows);
  CHECK(solver.format().cols == cols);
  const recon::AlignedWorkspace workspace(reconstructor.required_bytes());
  std::vector<float> expected(rows * cols), x(rows * cols), weights(solved_channels, 1.0F);
  weights[4] = 0.0F;
  for (const float level : {0.5F, 0.0F, 1.5F}) {
    const std::vector<float> y = samples(level);
    const recon::FrameInfo wanted = reconstructor.solve(y, weights, workspace.span(), expected);
    REQUIRE(wanted.health != recon::Health::invalid);
    const compueye::tests::HeapUse before = compueye::tests::heap_use_of_this_thread();
    const recon::FrameInfo info = solver.solve(y, weights, x);
    CHECK((compueye::tests::heap_use_of_this_thread() - before).calls() == 0);
    CHECK(x == expected);
    CHECK(info.objective == wanted.objective);
    CHECK(info.channels_reweighted == 1);
  }
}

TEST_CASE("two solvers may share a reconstructor, and one that is asked too much says so") {
  const recon::Reconstructor reconstructor = make_reconstructor();
  firmware::ReconstructorSolver one(reconstructor), other(reconstructor);
  std::vector<float> first(rows * cols), second(rows * cols), weights(solved_channels, 1.0F);
  CHECK(one.solve(samples(1.0F), weights, first).health == other.solve(samples(1.0F), weights, second).health);
  CHECK(first == second);
  weights[1] = weights[2] = weights[3] = 0.0F;  // three, and two were planned
  CHECK(one.solve(samples(1.0F), weights, first).health == recon::Health::invalid);
  CHECK(first == std::vector<float>(rows * cols, 0.0F));
}
