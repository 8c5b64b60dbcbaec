#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hal/result.hpp"
#include "recon/reconstructor.hpp"

namespace compueye::firmware {

/// What is compared, and on which samples of a board's eye.
struct CompareOptions {
  std::string scene;  ///< empty: the board's
  std::int64_t scene_seed = 0;
  std::int64_t seed = 0;                   ///< of the noise
  bool exact = false;                      ///< y = A x + n instead of the simulated eye
  std::string response;                    ///< file of another A for the board's eye; empty: the nominal one
  std::optional<double> sigma;             ///< of one sample, in white pixels, >= 0; absent: the board's
  std::optional<double> lambda;            ///< >= 0, for every contender; absent: by rule
  std::optional<std::int64_t> iterations;  ///< 1 .. 1e6, of every contender; absent: see compare()
  std::optional<std::int64_t> threads;     ///< 1 .. recon::WorkerThreads::most; absent: the board's
  std::vector<std::string> solvers;        ///< empty: all
  std::vector<std::string> bases;          ///< empty: all
  std::string constraint;                  ///< empty: the board's
};

/// A solver with a basis and constraint it takes.
struct Contender {
  recon::SolverKind solver = recon::SolverKind::admm;
  recon::BasisKind basis = recon::BasisKind::identity;
  recon::ConstraintKind constraint = recon::ConstraintKind::none;
};

/// Everything that goes together, by basis and then by solver: with `constraint` where the pair takes it, else with
/// none. Error usage for a name that does not exist, or when nothing is left.
[[nodiscard]] hal::Result<std::vector<Contender>> contenders(const CompareOptions& options,
                                                             recon::ConstraintKind of_board);

}  // namespace compueye::firmware
