#include <doctest/doctest.h>

#include <thread>
#include <vector>

#include "recon/reconstructor.hpp"
#include "tests/recon/random_problem.hpp"
#include "tests/recon/solve_frame.hpp"

using namespace compueye;
using namespace compueye::tests;

namespace {

struct Sample {
  std::vector<float> y;
  std::vector<float> weights;
};

/// Frames of 60 channels, some of them missing or doubted.
std::vector<Sample> some_frames(int count) {
  Random random(61);
  std::vector<Sample> frames;
  for (int f = 0; f < count; ++f) {
    Sample sample{to_float(random_vector(random, 60, 0.0, 4.0)), std::vector<float>(60, 1.0F)};
    for (int k = 0; k < f % 4; ++k) {
      sample.weights[static_cast<std::size_t>(random.below(60))] = k % 2 == 0 ? 0.0F : 0.5F;
    }
    frames.push_back(std::move(sample));
  }
  return frames;
}

}  // namespace

TEST_CASE("one solver gives four threads the same bits as one, each with its own workspace") {
  Random random(62);
  const recon::Response a = random_response(random, 60, Picture{10, 12}, 0.12);
  const std::vector<Sample> frames = some_frames(8);
  for (const auto basis : {recon::BasisKind::identity, recon::BasisKind::dct}) {
    for (const auto precision : {recon::Precision::f32, recon::Precision::f64}) {
      recon::Objective objective;
      objective.basis = basis;
      objective.constraint = recon::ConstraintKind::box;
      objective.lambda = 0.05;
      recon::Plan plan;
      plan.precision = precision;
      plan.iterations = 20;
      const auto solver = recon::Reconstructor::create(a, objective, plan).value();
      std::vector<SolvedFrame> expected;
      for (const Sample& frame : frames) expected.push_back(solve_frame(solver, frame.y, frame.weights));

      std::vector<std::vector<SolvedFrame>> solved(4);
      std::vector<std::thread> threads;
      for (std::vector<SolvedFrame>& mine : solved) {
        threads.emplace_back([&solver, &frames, &mine] {
          for (const Sample& frame : frames) mine.push_back(solve_frame(solver, frame.y, frame.weights));
        });
      }
      for (std::thread& thread : threads) thread.join();
      for (const std::vector<SolvedFrame>& mine : solved) {
        REQUIRE(mine.size() == expected.size());
        for (std::size_t f = 0; f < mine.size(); ++f) {
          CHECK(mine[f].x == expected[f].x);
          CHECK(mine[f].info.objective == expected[f].info.objective);
          CHECK(mine[f].info.health != recon::Health::invalid);
        }
      }
    }
  }
}

TEST_CASE("solvers set up at the same time do not disturb each other, and their factors are the same bits") {
  Random random(63);
  const recon::Response a = random_response(random, 60, Picture{10, 12}, 0.3);
  const auto make = [&a] {
    return recon::packed_inverse<float>(a, recon::MetricKind::identity, 0.5,
                                        [](std::string_view, double, double) { return true; })
        .value();
  };
  const std::vector<float> expected = make();
  std::vector<std::vector<float>> made(3);
  std::vector<std::thread> threads;
  for (std::vector<float>& mine : made) threads.emplace_back([&] { mine = make(); });
  for (std::thread& thread : threads) thread.join();
  for (const std::vector<float>& mine : made) CHECK(mine == expected);
}
