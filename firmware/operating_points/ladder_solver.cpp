#include "firmware/operating_points/ladder_solver.hpp"

#include <algorithm>

namespace compueye::firmware {

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

}  // namespace compueye::firmware
