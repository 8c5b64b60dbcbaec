#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "firmware/eye/reconstructor_maker.hpp"
#include "firmware/files/factor_cache.hpp"
#include "recon/solver_list.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/recon/random_problem.hpp"
#include "tests/recon/solve_frame.hpp"

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

TEST_CASE("a stored factor with right checksums and wrong values is made again, and the picture is the right one") {
  tests::Random random(6);
  const recon::Response a = tests::random_response(random, 30, tests::Picture{6, 6}, 0.5);
  std::vector<float> y(30);
  for (float& value : y) value = static_cast<float>(random.uniform());
  recon::Objective objective;
  objective.lambda = 0.1;
  using Solver = std::pair<const char*, recon::BasisKind>;
  for (const auto& [name, basis] : {Solver{"admm", recon::BasisKind::identity}, Solver{"admm", recon::BasisKind::tv},
                                    Solver{"adm", recon::BasisKind::dct}, Solver{"pdhg", recon::BasisKind::dct}}) {
    const std::string solver = name;
    CAPTURE(solver);
    recon::Plan plan;
    plan.solver = solver_named(solver);
    if (plan.solver == solver_named("pdhg")) plan.rank = 10;  // modes that leave something out
    objective.basis = basis;
    const test::TemporaryFolder folder;
    const std::string cache = folder.path().string();
    const FactorKey key = factor_key(a, recon::Reconstructor::wanted_factor(a, objective, plan));
    const auto frame = [&](FactorOrigin expected) {
      ReconstructorMaker maker(a, std::nullopt, cache, Memory::forgets);
      const auto reconstructor = maker.make(objective, plan, {});
      REQUIRE(reconstructor);
      CHECK(maker.origin() == expected);
      CHECK(maker.notes().empty() == (expected != FactorOrigin::replaced));
      return tests::solve_frame(*reconstructor, y).x;
    };
    const std::vector<float> right = frame(made);
    CHECK(frame(kept) == right);
    for (const float factor : {0.9F, -1.0F, std::nanf("")}) {
      recon::Factor forged = load_factor(cache, key).value();
      for (float& value : forged.values) value *= factor;
      REQUIRE(store_factor(cache, key, forged));
      CHECK(frame(FactorOrigin::replaced) == right);
      CHECK(frame(kept) == right);
    }
    // Of modes, a thousandth of their length makes frames diverge, and so does a bound below what they leave out.
    if (key.rank > 0) {
      const auto forge = [&](auto&& change) {
        recon::Factor forged = load_factor(cache, key).value();
        change(forged.values);
        REQUIRE(store_factor(cache, key, forged));
        CHECK(frame(FactorOrigin::replaced) == right);
      };
      const auto rank = static_cast<std::size_t>(key.rank);
      forge([&](auto& values) {
        for (std::size_t k = rank + 1; k < values.size(); ++k) values[k] *= 1.0005F;
      });
      forge([&](auto& values) {
        for (std::size_t k = rank + 1; k < values.size(); k += rank) values[k] *= 1.001F;
      });
      forge([&](auto& values) { values[rank] = 0.0F; });
      forge([&](auto& values) { values[rank] *= 0.5F; });
    }
    // A sound one of another eye.
    const recon::Response other = tests::random_response(random, 30, tests::Picture{6, 6}, 0.5);
    recon::Plan same_rho = plan;
    same_rho.rho = key.rank > 0 ? 0.0 : key.rho;
    const auto of_other = recon::Reconstructor::create(other, objective, same_rho);
    REQUIRE(of_other);
    REQUIRE(store_factor(cache, key, of_other->factor()));
    CHECK(frame(FactorOrigin::replaced) == right);
  }
}

TEST_CASE("a response whose details rounding would swallow is not rounded, which is said") {
  tests::Random random(7);
  for (const double pedestal : {0.0, 200.0}) {
    CAPTURE(pedestal);
    std::vector<double> values(20 * 64);
    for (double& value : values) value = pedestal + random.uniform();
    const auto a = recon::Response::from_dense(20, 64, values).value().with_image(8, 8).value();
    for (const auto kind : {recon::OperatorKind::dense_runs_bf16, recon::OperatorKind::dense_runs_int8}) {
      recon::Plan plan;
      plan.op = kind;
      ReconstructorMaker maker(a, kind, {});
      const auto made_of_it = maker.make({}, plan, {});
      REQUIRE(made_of_it);
      const bool rounds = pedestal == 0.0;
      CHECK((made_of_it->operating_point().op == kind) == rounds);
      CHECK((maker.response().content_hash() != a.content_hash()) == rounds);
      CHECK(maker.notes().size() == (rounds ? 0 : 1));
    }
  }
}
