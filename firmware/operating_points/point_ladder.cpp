#include "firmware/operating_points/point_ladder.hpp"

#include <algorithm>
#include <utility>

#include "hal/try.hpp"

namespace compueye::firmware {

hal::Result<PointLadder> make_ladder(const Board& board, const LivingResponse& living, const Sweep& sweep,
                                     const PointChoice& choice, const std::string& cache,
                                     const recon::Progress& progress) {
  PointLadder ladder;
  std::vector<Curve> curves;
  for (const std::size_t i : choice.ladder) {
    const MeasuredPoint& point = sweep.points[i];
    const auto known = std::find(curves.begin(), curves.end(), point.curve);
    const auto at = static_cast<std::size_t>(known - curves.begin());
    if (known == curves.end()) {
      Board curved = with_curve(board, point.curve);
      curved.plan.iterations = point.iterations;
      ladder.eyes.push_back(TRY(ReadyEye::make(curved, living, cache, progress)));
      curves.push_back(point.curve);
    }
    recon::OperatingPoint operating = ladder.eyes[at].reconstructor().operating_point();
    // The rungs of a curve come by falling iterations, so the eye has most of them: memory for the first is enough.
    operating.iterations = std::min(operating.iterations, point.iterations);
    ladder.rungs.push_back({at, operating});
  }
  return ladder;
}

LadderSolver::LadderSolver(PointLadder& ladder) : ladder_(ladder) {
  for (const ReadyEye& eye : ladder.eyes)
    solvers_.push_back(std::make_unique<ReconstructorSolver>(eye.reconstructor()));
}

recon::FrameInfo LadderSolver::solve(std::span<const float> y, std::span<const float> weights,
                                     std::span<float> x) noexcept {
  const PointLadder::Rung& rung = ladder_.rungs[wanted_.load(std::memory_order_relaxed)];
  // Iterations that were measured are within their range, so that this cannot fail.
  static_cast<void>(ladder_.eyes[rung.eye].set_iterations(rung.point.iterations));
  return solvers_[rung.eye]->solve(y, weights, x);
}

std::size_t LadderSolver::rung_of(const recon::OperatingPoint& point) const noexcept {
  const auto same = [&](const PointLadder::Rung& rung) {
    return rung.point.solver == point.solver && rung.point.basis == point.basis &&
           rung.point.precision == point.precision && rung.point.op == point.op &&
           rung.point.iterations == point.iterations;
  };
  return static_cast<std::size_t>(std::find_if(ladder_.rungs.begin(), ladder_.rungs.end(), same) -
                                  ladder_.rungs.begin());
}

void StepRule::step_to(std::size_t rung, std::int64_t now_ns) noexcept {
  const bool down = rung > rung_;
  // Taken back before it held: the load is still there.
  if (down && trying_) calm_ns_ = std::min(2 * calm_ns_, settings_.most_calm_ns);
  ++(down ? steps_down_ : steps_up_);
  trying_ = !down;
  rung_ = rung;
  weight_ = 0;
  in_time_ = 0;
  calm_since_ns_ = now_ns;
}

void StepRule::published(std::size_t rung, bool late, std::int64_t now_ns) noexcept {
  if (!begun_) calm_since_ns_ = now_ns;
  begun_ = true;
  if (late) ++misses_;
  if (rung != rung_) return;
  if (late) {
    weight_ += settings_.miss_weight;
    in_time_ = 0;
    calm_since_ns_ = now_ns;
    if (weight_ < settings_.weight_down) return;
    weight_ = settings_.weight_down;  // on the last rung it would grow without end
    if (rung_ + 1 < rungs_) step_to(rung_ + 1, now_ns);
    return;
  }
  weight_ = std::max(0, weight_ - 1);
  in_time_ = std::min(in_time_ + 1, settings_.calm_frames);
  if (in_time_ < settings_.calm_frames || now_ns - calm_since_ns_ < calm_ns_) return;
  if (trying_) {
    trying_ = false;
    calm_ns_ = settings_.calm_ns;
  }
  if (rung_ > 0) step_to(rung_ - 1, now_ns);
}

}  // namespace compueye::firmware
