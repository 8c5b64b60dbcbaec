#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "hal/result.hpp"
#include "recon/reconstructor.hpp"

namespace compueye::firmware {

/// What `compueye compare` was asked for.
struct CompareOptions {
  std::filesystem::path board;
  std::string scene;  ///< empty: the board's
  std::int64_t scene_seed = 0;
  std::int64_t seed = 0;
  bool exact = false;              ///< y = A x + n instead of the simulated eye
  std::filesystem::path response;  ///< empty: the nominal one
  std::optional<double> sigma;
  std::optional<double> lambda;
  std::optional<std::int64_t> iterations;
  std::optional<std::int64_t> threads;
  std::vector<std::string> solvers;  ///< empty: all
  std::vector<std::string> bases;    ///< empty: all
  std::string constraint;            ///< empty: the board's
  std::filesystem::path sheet;
  std::filesystem::path csv;
  bool json = false;

  /// Error usage, naming option and value.
  [[nodiscard]] hal::Result<void> check() const;
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
