#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "tests/memory/allocation_counter.hpp"
#include "tests/recon/every_setting.hpp"
#include "tests/recon/random_problem.hpp"
#include "tests/recon/solve_frame.hpp"

using namespace compueye;
using namespace compueye::tests;

TEST_CASE("solving a frame does not touch the heap, for any solver, basis, constraint and precision") {
  Random random(64);
  int solved = 0;
  for (const double density : {0.08, 0.6}) {  // csr and dense operators
    const recon::Response a = random_response(random, 40, Picture{10, 13}, density);
    const auto y = to_float(random_vector(random, 40, 0.0, 4.0));
    std::vector<float> weights(40, 1.0F), bad = y, x(130);
    weights[2] = weights[11] = weights[39] = 0.0F;
    weights[20] = 0.25F;
    bad[7] = std::nanf("");
    std::vector<SolverSetting> settings = every_setting();
    for (SolverSetting setting : every_setting()) {
      if (!setting.plan.solver->minimises || setting.objective.epsilon) continue;
      setting.name += " huber";
      setting.objective.huber = 1e-3;
      settings.push_back(setting);
    }
    for (const SolverSetting& setting : settings) {
      CAPTURE(setting.name);
      const auto solver = recon::Reconstructor::create(a, setting.objective, setting.plan).value();
      const recon::AlignedWorkspace workspace(solver.required_bytes());
      const HeapUse before = heap_use_of_this_thread();
      const auto whole = solver.solve(y, {}, workspace.span(), x);
      const auto with_missing = solver.solve(y, weights, workspace.span(), x);
      const auto invalid = solver.solve(bad, weights, workspace.span(), x);
      const auto refused = solver.solve(y, weights, workspace.span().first(64), x);
      const std::size_t bytes = solver.required_bytes();
      const recon::OperatingPoint point = solver.operating_point();
      const HeapUse used = heap_use_of_this_thread() - before;
      CHECK(used.calls() == 0);
      CHECK(whole.health != recon::Health::invalid);
      CHECK(with_missing.channels_reweighted == (setting.objective.huber ? 6 : 4));
      CHECK(invalid.health == recon::Health::invalid);
      CHECK(refused.health == recon::Health::invalid);
      CHECK(bytes == workspace.span().size());
      CHECK(point.precision == setting.plan.precision);
      ++solved;
    }
  }
  CHECK(solved > 2 * static_cast<int>(every_setting().size()));
  CHECK(solved > 200);
}
