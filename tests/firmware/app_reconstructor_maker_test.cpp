#include <doctest/doctest.h>

#include <vector>

#include "firmware/eye/reconstructor_maker.hpp"
#include "recon/solver_list.hpp"
#include "tests/recon/random_problem.hpp"

using namespace compueye;
using namespace compueye::firmware;
using recon::solver_named;

namespace {

/// Where the factors are from when `solver` is set up with one lambda after the other, without a cache.
std::vector<FactorOrigin> origins(ReconstructorMaker::Memory memory, recon::SolverKind solver,
                                  recon::Precision precision = recon::Precision::f32) {
  tests::Random random(5);
  const recon::Response a = tests::random_response(random, 12, tests::Picture{6, 6}, 0.5);
  ReconstructorMaker maker(a, std::nullopt, {}, memory);
  recon::Plan plan;
  plan.solver = solver;
  plan.precision = precision;
  plan.rho = 0.5;
  std::vector<FactorOrigin> found;
  for (const double lambda : {0.1, 0.2, 0.1}) {
    recon::Objective objective;
    objective.lambda = lambda;
    REQUIRE(maker.make(objective, plan, {}));
    found.push_back(maker.origin());
  }
  CHECK(maker.notes().empty());
  return found;
}

using Memory = ReconstructorMaker::Memory;
constexpr auto made = FactorOrigin::made, kept = FactorOrigin::kept;

}  // namespace

TEST_CASE("a maker that remembers makes a factor once for every lambda") {
  for (const char* solver : {"admm", "adm", "pdhg"}) {
    CAPTURE(solver);
    CHECK(origins(Memory::remembers, solver_named(solver)) == std::vector{made, kept, kept});
    CHECK(origins(Memory::forgets, solver_named(solver)) == std::vector{made, made, made});
  }
}

TEST_CASE("what no other reconstructor could want is not remembered") {
  const std::vector each_its_own{made, made, made};
  CHECK(origins(Memory::remembers, solver_named("tikhonov")) == each_its_own);  // rho is lambda
  CHECK(origins(Memory::remembers, solver_named("cp")) == each_its_own);
  CHECK(origins(Memory::remembers, solver_named("admm"), recon::Precision::f64) == each_its_own);
}
