#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "recon/solver_list.hpp"
#include "tests/recon/random_problem.hpp"
#include "tests/recon/solve_frame.hpp"

using namespace compueye;
using namespace compueye::tests;

namespace {

struct Scene {
  recon::Response a;

  /// Samples of a picture of its own, with noise of its own.
  [[nodiscard]] std::vector<float> samples(std::uint64_t picture, std::uint64_t noise) const {
    Random of_picture(picture), of_noise(noise);
    std::vector<double> x(static_cast<std::size_t>(a.cols())), clean(static_cast<std::size_t>(a.rows()));
    for (double& v : x) v = of_picture.uniform() < 0.3 ? of_picture.uniform(0.2, 1.0) : 0.0;
    a.forward(x, clean);
    std::vector<float> out;
    for (const double v : clean) out.push_back(static_cast<float>(v + 0.01 * of_noise.normal()));
    return out;
  }
};

Scene some_scene() {
  Random random(31);
  return {random_response(random, 40, Picture{8, 10}, 0.4)};
}

recon::Reconstructor make(const recon::Response& a, int iterations, bool warm,
                          recon::BasisKind basis = recon::BasisKind::dct,
                          recon::Precision precision = recon::Precision::f32) {
  recon::Objective objective;
  objective.basis = basis;
  objective.constraint = recon::ConstraintKind::box;
  objective.lambda = 0.02;
  recon::Plan plan;
  plan.solver = recon::solver_named("pdhg");
  plan.iterations = iterations;
  plan.precision = precision;
  plan.warm_start = warm;
  return recon::Reconstructor::create(a, objective, plan).value();
}

/// Solves frames one after the other in one workspace, whose first content is arbitrary.
class Sequence {
 public:
  explicit Sequence(const recon::Reconstructor& solver, unsigned char garbage = 0xA5)
      : solver_(solver), workspace_(solver.required_bytes()) {
    std::fill(workspace_.span().begin(), workspace_.span().end(), std::byte{garbage});
  }
  SolvedFrame next(const std::vector<float>& y, const std::vector<float>& weights = {}) {
    SolvedFrame frame;
    frame.x.resize(static_cast<std::size_t>(solver_.pixels()));
    frame.info = solver_.solve(y, weights, workspace_.span(), frame.x);
    return frame;
  }
  void forget() { solver_.forget_last_frame(workspace_.span()); }

 private:
  const recon::Reconstructor& solver_;
  recon::AlignedWorkspace workspace_;
};

}  // namespace

TEST_CASE("a scene that stands still converges over its frames") {
  const Scene scene = some_scene();
  for (const auto basis : {recon::BasisKind::identity, recon::BasisKind::dct, recon::BasisKind::tv}) {
    for (const auto precision : {recon::Precision::f32, recon::Precision::f64}) {
      const auto cold = make(scene.a, 6, false, basis, precision), warm = make(scene.a, 6, true, basis, precision);
      const auto converged = solve_frame(make(scene.a, 3000, false, basis, precision), scene.samples(1, 1));
      Sequence frames(warm);
      SolvedFrame frame;
      for (int f = 0; f < 20; ++f) {
        frame = frames.next(scene.samples(1, 1));
        CHECK(frame.info.warm == (f > 0));
      }
      const double excess_cold = solve_frame(cold, scene.samples(1, 1)).info.objective / converged.info.objective - 1.0;
      CHECK(frame.info.objective / converged.info.objective - 1.0 < 0.1 * excess_cold);
    }
  }
}

TEST_CASE("a cold frame of a warm plan has the bits of a cold plan") {
  const Scene scene = some_scene();
  const auto cold = make(scene.a, 9, false), warm = make(scene.a, 9, true);
  const auto y = scene.samples(1, 1);
  CHECK(Sequence(warm).next(y).x == Sequence(cold).next(y).x);
  CHECK(Sequence(warm, 0).next(y).x == Sequence(cold).next(y).x);
  CHECK(warm.required_bytes() > cold.required_bytes());
  Sequence frames(warm);
  frames.next(scene.samples(2, 3));
  frames.forget();
  const SolvedFrame again = frames.next(y);
  CHECK_FALSE(again.info.warm);
  CHECK(again.x == Sequence(cold).next(y).x);
}

TEST_CASE("the same frames in the same order give the same bits") {
  const Scene scene = some_scene();
  const auto warm = make(scene.a, 5, true);
  Sequence first(warm, 0), second(warm, 0xFF);
  for (std::uint64_t f = 0; f < 6; ++f) {
    const auto y = scene.samples(1, f);
    const SolvedFrame a = first.next(y), b = second.next(y);
    CHECK(a.x == b.x);
    CHECK(a.info.warm == b.info.warm);
  }
}

TEST_CASE("a cut starts cold, noise does not") {
  const Scene scene = some_scene();
  const auto warm = make(scene.a, 5, true);
  Sequence frames(warm);
  CHECK_FALSE(frames.next(scene.samples(1, 1)).info.warm);
  CHECK(frames.next(scene.samples(1, 2)).info.warm);
  CHECK_FALSE(frames.next(scene.samples(2, 3)).info.warm);
  CHECK(frames.next(scene.samples(2, 4)).info.warm);
}

TEST_CASE("channels that come and go, and frames that fail, leave a sound state") {
  const Scene scene = some_scene();
  const auto warm = make(scene.a, 8, true);
  Sequence frames(warm);
  std::vector<float> weights(40, 1.0F);
  weights[3] = 0.0F;
  weights[20] = 0.4F;
  auto y = scene.samples(1, 1);
  frames.next(y);
  y[3] = std::nanf("");
  const SolvedFrame missing = frames.next(y, weights);
  CHECK(missing.info.warm);
  CHECK(missing.info.health != recon::Health::invalid);
  CHECK(frames.next(y).info.health == recon::Health::invalid);  // NaN at a channel in use
  const SolvedFrame back = frames.next(scene.samples(1, 2));
  CHECK(back.info.warm);  // the failed frame changed nothing
  CHECK(std::all_of(back.x.begin(), back.x.end(), [](float v) { return v >= 0.0F && v <= 1.0F; }));
  // Another problem in the same memory is another problem.
  const auto other = make(scene.a, 8, true, recon::BasisKind::haar);
  recon::AlignedWorkspace memory(std::max(other.required_bytes(), warm.required_bytes()));
  std::vector<float> x(80);
  CHECK_FALSE(warm.solve(scene.samples(1, 1), {}, memory.span(), x).warm);
  CHECK(warm.solve(scene.samples(1, 2), {}, memory.span(), x).warm);
  CHECK_FALSE(other.solve(scene.samples(1, 2), {}, memory.span(), x).warm);
}

TEST_CASE("only pdhg goes on from the last frame") {
  const Scene scene = some_scene();
  recon::Plan plan;
  plan.warm_start = true;
  CHECK(recon::Reconstructor::create(scene.a, {}, plan).error().code == hal::ErrorCode::usage);
}
