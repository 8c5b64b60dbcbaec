#pragma once

#include <vector>

#include "recon/reconstructor.hpp"
#include "studies/stability/hard_case.hpp"

namespace compueye::firmware {

struct CaseWay {
  recon::SolverKind solver = nullptr;
  recon::Precision precision = recon::Precision::f32;
  int iterations = 0;
};

struct CaseFrame {
  recon::FrameInfo info;
  std::vector<float> x;
};

/// One frame of a problem, with its duality gap where there is one. Errors: those of Reconstructor::create().
[[nodiscard]] hal::Result<CaseFrame> run_case(const HardProblem& problem, const recon::Objective& objective,
                                              const CaseWay& way);

/// The objective with the case's lambda: a share of what makes the picture zero or, for direct methods, of ||A||_F^2.
[[nodiscard]] recon::Objective with_lambda(const recon::Objective& objective, const HardCase& hard,
                                           const HardProblem& problem, recon::SolverKind solver);

}  // namespace compueye::firmware
