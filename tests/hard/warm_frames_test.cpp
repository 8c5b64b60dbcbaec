// A warm start from whatever was there before, and many frames one after the other: a short run here, tools/soak
// --frames N goes on for as long as you like.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <string>

#include "recon/aligned_workspace.hpp"
#include "recon/solver_list.hpp"
#include "tests/hard/hard_eyes.hpp"
#include "tests/hard/instruction_counter.hpp"
#include "tests/recon/random_problem.hpp"
#include "tests/recon/solve_frame.hpp"

using namespace compueye;
using namespace compueye::tests;

namespace {

recon::Reconstructor pdhg(const recon::Response& a, int iterations, bool warm, recon::BasisKind basis) {
  recon::Objective objective;
  objective.basis = basis;
  objective.constraint = recon::ConstraintKind::box;
  objective.lambda = 1e-3 * a.squared_norm() / a.rows();
  recon::Plan plan;
  plan.solver = recon::solver_named("pdhg");
  plan.iterations = iterations;
  plan.warm_start = warm;
  return recon::Reconstructor::create(a, objective, plan).value();
}

constexpr long round_trip = 500;

/// A bright spot that goes round over a dim ground; `frame` says where it is.
std::vector<float> scene(const recon::Response& a, long frame) {
  const int rows = a.image_rows(), cols = a.image_cols();
  const double angle = 2.0 * std::numbers::pi * static_cast<double>(frame % round_trip) / round_trip;
  const double row = rows * (0.5 + 0.3 * std::sin(angle)), col = cols * (0.5 + 0.3 * std::cos(angle));
  std::vector<double> x, y(static_cast<std::size_t>(a.rows()));
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < cols; ++c) x.push_back(std::hypot(r - row, c - col) < 0.15 * rows ? 0.9 : 0.1);
  }
  a.forward(x, y);
  Random noise(static_cast<std::uint64_t>(frame) + 1);
  for (double& value : y) value += 0.01 * noise.normal();
  return to_float(y);
}

/// Frames of a scene that changes, in one workspace.
class WarmFrames {
 public:
  WarmFrames(const recon::Response& a, int iterations)
      : a_(a),
        warm_(pdhg(a, iterations, true, recon::BasisKind::dct)),
        cold_(pdhg(a, 5 * iterations, false, recon::BasisKind::dct)),
        workspace_(warm_.required_bytes()),
        x_(static_cast<std::size_t>(warm_.pixels())) {}

  /// Solves this frame.
  recon::FrameInfo next(long frame) {
    y_ = scene(a_, frame);
    return warm_.solve(y_, {}, workspace_.span(), x_);
  }
  /// Its objective over that of many cold iterations.
  [[nodiscard]] double excess(const recon::FrameInfo& info) const {
    return info.objective / solve_frame(cold_, y_).info.objective;
  }
  /// Of solving the last frame again, which is what every frame costs.
  [[nodiscard]] std::optional<std::uint64_t> instructions() {
    return count_instructions([&] { static_cast<void>(warm_.solve(y_, {}, workspace_.span(), x_)); });
  }
  [[nodiscard]] const std::vector<float>& x() const noexcept { return x_; }

 private:
  const recon::Response& a_;
  recon::Reconstructor warm_, cold_;
  recon::AlignedWorkspace workspace_;
  std::vector<float> x_, y_;
};

/// The worst of some frames from `first` on.
double worst_excess(WarmFrames& frames, long first, long count) {
  double worst = 0.0;
  for (long f = first; f < first + count; ++f) worst = std::max(worst, frames.excess(frames.next(f)));
  return worst;
}

long frames_asked(long usual) {
  const char* asked = std::getenv("COMPUEYE_WARM_FRAMES");
  const long count = asked == nullptr ? usual : std::atol(asked);
  return (count + round_trip - 1) / round_trip * round_trip;
}

/// `count` is a whole number of round trips.
void check_no_drift(const recon::Response& a, int iterations, long count) {
  WarmFrames frames(a, iterations);
  constexpr long at_ends = 20;
  static_cast<void>(worst_excess(frames, 0, at_ends));  // until it is warm
  const double first = worst_excess(frames, at_ends, at_ends);
  const auto began = frames.instructions();
  for (long f = 2 * at_ends; f < count + at_ends; ++f) {
    const recon::FrameInfo info = frames.next(f);
    if (info.health == recon::Health::invalid) FAIL("frame " << f << " is invalid");
  }
  // The same places of the scene with other noise: what has built up in a state would show.
  const double last = worst_excess(frames, count + at_ends, at_ends);
  std::printf("%ld frames: objective over that of a cold solution at most %.4f at first, %.4f at last\n", count, first,
              last);
  CHECK(last <= 1.05 * first);
  CHECK(std::all_of(frames.x().begin(), frames.x().end(), [](float v) { return v >= 0.0F && v <= 1.0F; }));
  const auto ended = frames.instructions();
  if (!began || !ended) {
    std::printf("instructions of the first and last frame not counted: this machine has no counter for them\n");
    return;
  }
  std::printf("%llu instructions a frame at first, %llu at last\n", static_cast<unsigned long long>(*began),
              static_cast<unsigned long long>(*ended));
  CHECK(static_cast<double>(*ended) <= 1.02 * static_cast<double>(*began));
}

}  // namespace

TEST_CASE("a warm start from a wrong frame, a broken one or another distance is over within the frame") {
  const recon::Response a = ordinary_eye();
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<float> y = scene(a, 0);
  const auto times = [&](float factor) {
    std::vector<float> changed = y;
    for (float& value : changed) value *= factor;
    return changed;
  };
  std::vector<float> broken = y, outlier = y, turned(y.rbegin(), y.rend()), other(y.size());
  broken[4] = nan;
  outlier[4] = 1e6F;
  const std::vector<float> of_other_eye = scene(eye_of_10_deg(), 0);  // as from another depth: the same scene, larger
  for (const auto basis : {recon::BasisKind::identity, recon::BasisKind::dct, recon::BasisKind::tv}) {
    const recon::Reconstructor warm = pdhg(a, 80, true, basis), cold = pdhg(a, 80, false, basis);
    const double right = solve_frame(cold, y).info.objective;
    for (const auto& before :
         {turned, times(0.0F), times(-1.0F), times(100.0F), times(1e-6F), broken, outlier, of_other_eye}) {
      const recon::AlignedWorkspace workspace(warm.required_bytes());
      std::vector<float> x(static_cast<std::size_t>(warm.pixels()));
      static_cast<void>(warm.solve(before, {}, workspace.span(), x));
      const recon::FrameInfo info = warm.solve(y, {}, workspace.span(), x);
      CHECK(info.health != recon::Health::invalid);
      CHECK(info.objective <= 1.01 * right);
      CHECK(std::all_of(x.begin(), x.end(), [](float v) { return v >= 0.0F && v <= 1.0F; }));
    }
  }
}

TEST_CASE("warm frames neither drift nor slow down: 64 samples, 256 pixels") {
#if defined(COMPUEYE_SANITIZED)
  constexpr long usual = 500;
#else
  constexpr long usual = 20'000;
#endif
  check_no_drift(eye_8x8(), 5, frames_asked(usual));
}

TEST_CASE("warm frames neither drift nor slow down: 80 x 80 ommatidia" * doctest::skip()) {
  check_no_drift(large_eye(), 5, frames_asked(50'000) / 100);
}
