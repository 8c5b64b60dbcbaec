#include "studies/comparison/compare_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "firmware/app/options/named_kinds.hpp"
#include "recon/option_names.hpp"
#include "recon/solver_table.hpp"
#include "recon/worker_threads.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::Result;

Result<void> need(bool ok, const char* option, const std::string& sentence) {
  if (ok) return {};
  return hal::fail(ErrorCode::usage, option, sentence);
}

Result<void> not_negative(const char* option, const std::optional<double>& value) {
  const bool ok = !value || (std::isfinite(*value) && *value >= 0.0 && *value <= 1e12);
  return need(ok, option, fmt::format("is {}, expected a number from 0 to 1e12", value.value_or(0.0)));
}

}  // namespace

Result<void> CompareOptions::check() const {
  return need(!board.empty(), "--board", "is missing, for example --board boards/sim-8x8")
      .and_then([&] { return need(seed >= 0, "--seed", "is negative, expected 0 or more"); })
      .and_then([&] { return need(scene_seed >= 0, "--scene-seed", "is negative, expected 0 or more"); })
      .and_then([&] { return not_negative("--sigma", sigma); })
      .and_then([&] { return not_negative("--lambda", lambda); })
      .and_then([&] {
        return need(!iterations || (*iterations >= 1 && *iterations <= 1'000'000), "--iterations",
                    fmt::format("is {}, expected 1 to 1000000", iterations.value_or(0)));
      })
      .and_then([&] {
        return need(!threads || (*threads >= 1 && *threads <= recon::WorkerThreads::most), "--threads",
                    fmt::format("is {}, expected 1 to {}", threads.value_or(0), recon::WorkerThreads::most));
      });
}

Result<std::vector<Contender>> contenders(const CompareOptions& options, recon::ConstraintKind of_board) {
  const auto solvers = kinds_of("--solvers", options.solvers, recon::solver_names());
  if (!solvers) return tl::unexpected(solvers.error());
  const auto bases = kinds_of("--bases", options.bases, recon::basis_names());
  if (!bases) return tl::unexpected(bases.error());
  std::vector<std::string> word;
  if (!options.constraint.empty()) word.push_back(options.constraint);
  const auto constraints = kinds_of("--constraint", word, recon::constraint_names());
  if (!constraints) return tl::unexpected(constraints.error());
  const recon::ConstraintKind wanted = word.empty() ? of_board : constraints->front();
  std::vector<Contender> all;
  for (const recon::BasisKind basis : *bases) {
    for (const recon::SolverKind solver : *solvers) {
      for (const recon::ConstraintKind constraint : {wanted, recon::ConstraintKind::none}) {
        if (!recon::supports(solver, basis, constraint)) continue;
        all.push_back({solver, basis, constraint});
        break;
      }
    }
  }
  if (!all.empty()) return all;
  return hal::fail(ErrorCode::usage, "--solvers",
                   "and --bases leave nothing to compare; `compueye reconstruct --help` says what goes with what");
}

}  // namespace compueye::firmware
