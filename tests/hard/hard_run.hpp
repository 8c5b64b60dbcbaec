#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hal/error.hpp"
#include "recon/reconstructor.hpp"
#include "tests/hard/hard_row.hpp"

namespace compueye::tests {

/// A solver with a basis and constraint that it takes, in one precision.
struct HardSetting {
  recon::SolverKind solver = nullptr;
  recon::BasisKind basis = recon::BasisKind::identity;
  recon::ConstraintKind constraint = recon::ConstraintKind::none;
  recon::Precision precision = recon::Precision::f32;

  [[nodiscard]] std::string name() const;
};

/// Those that a row is for. Under a sanitizer, where digits are not what is looked at, one in eleven, others for other
/// rows.
[[nodiscard]] std::vector<HardSetting> settings_of(const HardRow& row);

/// What a setting made of a problem, or why it refused to.
struct HardRun {
  std::optional<hal::Error> refused;
  recon::Objective objective;
  recon::FrameInfo info;
  std::vector<float> x;
};

[[nodiscard]] recon::Objective objective_of(const HardRow& row, const HardSetting& setting,
                                            const firmware::HardProblem& problem);
[[nodiscard]] recon::Plan plan_of(const HardRow& row, const HardSetting& setting, const firmware::HardProblem& problem);
[[nodiscard]] HardRun run(const recon::Objective& objective, const recon::Plan& plan,
                          const firmware::HardProblem& problem);
[[nodiscard]] HardRun run(const HardRow& row, const HardSetting& setting, const firmware::HardProblem& problem);

}  // namespace compueye::tests
