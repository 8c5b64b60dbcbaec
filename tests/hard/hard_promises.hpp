#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tests/hard/hard_judge.hpp"
#include "tests/hard/hard_run.hpp"

namespace compueye::tests {

/// A promise that a run broke: its word, and what was found.
struct Broken {
  std::string promise;
  std::string found;
};

/// The promises, each with its word:
///   finite      the picture, its objective, its residual
///   named       a refusal has a place and is no surprise
///   inside      the picture keeps its constraint
///   converged   such a frame is within twice the gap's promise (1e-3) of the least objective
///   gap         what it says it is off by is no less than what it is off by
///   no worse than dark   its objective is at most that of a dark picture
///   zero, refused, invalid   where the row says so
class HardPromises {
 public:
  HardPromises(const HardRow& row, const firmware::HardProblem& problem);

  [[nodiscard]] std::vector<Broken> broken_by(const HardSetting& setting, const HardRun& run);

 private:
  void check_value(const HardSetting& setting, const HardRun& run, std::vector<Broken>& broken);
  [[nodiscard]] std::optional<double> least_of(const HardSetting& setting, const recon::Objective& objective);

  const HardRow& row_;
  std::optional<HardJudge> judge_;
  std::map<std::pair<recon::BasisKind, recon::ConstraintKind>, std::optional<double>> least_;
};

}  // namespace compueye::tests
