#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hal/result.hpp"
#include "recon/problem/response.hpp"
#include "recon/reconstructor.hpp"
#include "recon/setup/factor.hpp"
#include "studies/stability/hard_case.hpp"

namespace compueye::firmware {

struct StabilityOptions {
  std::vector<std::string> solvers;  ///< names; empty: all
  std::vector<std::string> cases;    ///< names; empty: all
  recon::Objective objective;        ///< but for its lambda, which a case has
  int iterations = 300;              ///< of a run
  std::uint64_t seed = 1;            ///< of picture and noise
};

/// How a run ended.
enum class StableEnd : std::uint8_t {
  converged,
  budget_used,
  invalid,  ///< a black picture, and health says so
  refused,  ///< at set-up, in a sentence
  wrong     ///< not finite, or "converged" further from the optimum than twice what that promises
};
[[nodiscard]] std::string_view name(StableEnd end) noexcept;

/// A case solved by one solver in one precision.
struct StableRun {
  recon::SolverKind solver = nullptr;
  recon::ConstraintKind constraint = recon::ConstraintKind::none;  ///< the wanted one, or none where it takes no other
  recon::Precision precision = recon::Precision::f32;
  StableEnd end = StableEnd::refused;
  std::string refusal;  ///< why
  /// How far the picture's objective, taken in double, lies above the largest lower bound of the optimum that any
  /// double run of the same problem has proven (by duality), as a share of itself. None: no bound is known, as for
  /// methods with objectives of their own.
  std::optional<double> accuracy;
  double objective = 0.0;  ///< in double, of the picture that was handed out
};

struct StableCase {
  HardCase hard;
  double condition = 0.0;       ///< of its response
  std::vector<StableRun> runs;  ///< f32 and f64 of each solver in turn
};

struct Stability {
  std::string eye;  ///< board or file
  int channels = 0;
  int rows = 0, cols = 0;
  StabilityOptions options;
  std::vector<StableCase> cases;
  std::size_t planned = 0;  ///< cases that there would be without a stop
};

/// Solves every case of hard_cases() with every solver in both precisions. A stop (`progress` returning false) keeps
/// the cases that are done. Errors: usage (a name that does not exist), out_of_range (an eye that is too large for
/// this, or sees nothing), interrupted before the first case was done.
[[nodiscard]] hal::Result<Stability> measure_stability(const recon::Response& eye, const std::string& name,
                                                       const StabilityOptions& options,
                                                       const recon::Progress& progress);

/// Beyond this M times N dense decompositions take minutes a case.
inline constexpr std::int64_t most_entries_for_stability = std::int64_t{1} << 21;

}  // namespace compueye::firmware
