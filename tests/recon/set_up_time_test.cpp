// A set-up that takes long says so before it begins.

#include <doctest/doctest.h>

#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "recon/reconstructor.hpp"
#include "recon/setup/on_all_cores.hpp"
#include "recon/setup/solver_row.hpp"
#include "recon/solver_list.hpp"
#include "tests/recon/random_problem.hpp"

using namespace compueye;
using namespace compueye::tests;

namespace {

/// So many pixels, each seen by a row of its own: quick to make, and as long to invert as any matrix of that order.
recon::Response pixel_by_pixel(const Picture& picture) {
  const int count = picture.rows * picture.cols;
  Random random(5);
  std::vector<std::int64_t> start{0};
  std::vector<std::int32_t> columns;
  for (int k = 0; k < count; ++k) {
    columns.push_back(k);
    start.push_back(k + 1);
  }
  return recon::Response::from_csr(count, count, start, columns, random_vector(random, count, 0.5, 1.0))
      .value()
      .with_image(picture.rows, picture.cols)
      .value();
}

struct Heard {
  std::vector<double> expected;  ///< seconds
  int told = 0;
  int told_before = 0;  ///< what was expected

  /// Of somebody who gives up at the first word, or never.
  recon::Progress listener(bool gives_up) {
    return {[this, gives_up](std::string_view, double, double) {
              ++told;
              return !gives_up;
            },
            [this](std::string_view what, double seconds) {
              CHECK(what == "set-up");
              expected.push_back(seconds);
              told_before = told;
            }};
  }
};

recon::Plan plan_of(std::string_view solver) {
  recon::Plan plan;
  plan.solver = recon::solver_named(solver);
  plan.rank = plan.solver->rank == recon::RankUse::singular_values ? 20 : 0;
  return plan;
}

recon::Objective ordinary() {
  recon::Objective objective;
  objective.lambda = 0.1;
  return objective;
}

}  // namespace

TEST_CASE("a set-up of more than a few seconds is told before anything of it is done, and a stored factor takes none") {
  const recon::Response large = pixel_by_pixel({50, 80}), small = pixel_by_pixel({10, 12});
  for (const std::string_view solver : {"admm", "tikhonov", "pdhg", "tsvd"}) {
    CAPTURE(solver);
    Heard heard, of_small;
    const auto made = recon::Reconstructor::create(large, ordinary(), plan_of(solver), {}, heard.listener(true));
    REQUIRE_FALSE(made.has_value());
    CHECK(made.error().code == hal::ErrorCode::interrupted);
    REQUIRE(heard.expected.size() == 1);
    CHECK(heard.expected.front() > 3.0);
    CHECK(heard.told_before == 0);
    CHECK(recon::Reconstructor::create(small, ordinary(), plan_of(solver), {}, of_small.listener(false)).has_value());
    CHECK(of_small.expected.empty());
    CHECK(of_small.told > 0);
  }
  recon::Factor stored = recon::Reconstructor::wanted_factor(large, ordinary(), plan_of("admm"));
  stored.values.resize(4000 * 4001 / 2);
  Heard heard;
  CHECK(recon::Reconstructor::create(large, ordinary(), plan_of("admm"), std::move(stored), heard.listener(false))
            .has_value());
  CHECK(heard.expected.empty());
}

TEST_CASE("work that cannot be counted goes on by the time it is expected to take, and is never told as done before") {
  CHECK(recon::likely_share(1.0, 0.0) == 0.0);
  CHECK(recon::likely_share(5.0, 10.0) == 0.5);
  double last = 0.0;
  for (const double elapsed : {1.0, 8.9, 9.1, 10.0, 30.0, 1e6}) {
    const double share = recon::likely_share(elapsed, 10.0);
    CHECK(share > last);
    CHECK(share < 1.0);
    last = share;
  }
  std::atomic<bool> seen{false};
  const recon::Progress sees = [&](std::string_view, double done, double total) {
    if (done > 0.0 && done < total) seen = true;
    return true;
  };
  const auto until_seen = [&] {
    return [&](int) {
      while (!seen) std::this_thread::yield();
    };
  };
  CHECK(recon::on_all_cores(1, "one long piece", sees, until_seen, 0.01));
}
