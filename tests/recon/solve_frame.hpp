#pragma once

#include <vector>

#include "recon/aligned_workspace.hpp"
#include "recon/reconstructor.hpp"

namespace compueye::tests {

struct SolvedFrame {
  recon::FrameInfo info;
  std::vector<float> x;
};

inline SolvedFrame solve_frame(const recon::Reconstructor& solver, const std::vector<float>& y,
                               const std::vector<float>& weights = {}) {
  const recon::AlignedWorkspace workspace(solver.required_bytes());
  SolvedFrame frame;
  frame.x.resize(static_cast<std::size_t>(solver.pixels()));
  frame.info = solver.solve(y, weights, workspace.span(), frame.x);
  return frame;
}

}  // namespace compueye::tests
