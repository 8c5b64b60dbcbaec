#include "tests/hard/hard_promises.hpp"

#include <algorithm>
#include <cmath>

#include "recon/problem/number_text.hpp"
#include "recon/solver_list.hpp"

namespace compueye::tests {
namespace {

using recon::Health;
using recon::number_text;

constexpr double promised_gap = 1e-3;
/// What neither the judge's double nor a picture rounded to float32 can tell from nought, as a share of darkness.
constexpr double rounding_share = 1e-9;

bool all_zero(const std::vector<float>& x) {
  return std::all_of(x.begin(), x.end(), [](float value) { return value == 0.0F; });
}

bool finite(const HardRun& run) {
  const auto& info = run.info;
  return std::all_of(run.x.begin(), run.x.end(), [](float value) { return std::isfinite(value); }) &&
         std::isfinite(info.objective) && std::isfinite(info.residual) && std::isfinite(info.primal_residual) &&
         std::isfinite(info.dual_residual) && std::isfinite(info.duality_gap);
}

bool inside(const HardRun& run) {
  const recon::Objective& o = run.objective;
  const float lo = o.constraint == recon::ConstraintKind::box ? static_cast<float>(o.lo) : 0.0F;
  return o.constraint == recon::ConstraintKind::none || std::all_of(run.x.begin(), run.x.end(), [&](float value) {
           return value >= lo && (o.constraint != recon::ConstraintKind::box || value <= static_cast<float>(o.hi));
         });
}

}  // namespace

// A sanitizer makes the judge in double cost minutes, and changes no digit that it looks at.
#if defined(COMPUEYE_SANITIZED)
constexpr bool judges = false;
#else
constexpr bool judges = true;
#endif

HardPromises::HardPromises(const HardRow& row, const firmware::HardProblem& problem) : row_(row) {
  if (judges && row.judged && (row.must == Must::be_solved || row.must == Must::be_zero)) judge_.emplace(problem);
}

std::optional<double> HardPromises::least_of(const HardSetting& setting, const recon::Objective& objective) {
  if (setting.solver == recon::solver_named("tikhonov")) return judge_->least_of_tikhonov(objective.lambda);
  if (!setting.solver->minimises) return std::nullopt;
  const auto key = std::make_pair(setting.basis, setting.constraint);
  const auto known = least_.find(key);
  if (known != least_.end()) return known->second;
  return least_.emplace(key, judge_->least(objective)).first->second;
}

void HardPromises::check_value(const HardSetting& setting, const HardRun& run, std::vector<Broken>& broken) {
  const double value = judge_->value(run.objective, setting.solver, judge_->picture(run.x));
  const double dark = judge_->value_of_dark(), rounding = rounding_share * dark;
  if (value > dark * (1.0 + promised_gap)) {
    broken.push_back({"no worse than dark", number_text(value) + " against " + number_text(dark)});
  }
  const std::optional<double> least = least_of(setting, run.objective);
  if (!least) return;
  const bool close = value <= *least * (1.0 + 2.0 * promised_gap) + rounding;
  if (run.info.health == Health::converged && !close) {
    broken.push_back({"converged", number_text(value) + " against " + number_text(*least)});
  }
  if (run.info.duality_gap < 0.0) return;
  // Relative to the objective, so that the judge's unit does not matter.
  const double said = run.info.objective > 0.0 ? run.info.duality_gap / run.info.objective : 0.0;
  if (said * value < value - *least - promised_gap * value - rounding) {
    broken.push_back({"gap", number_text(said) + " of " + number_text(value) + ", least " + number_text(*least)});
  }
}

std::vector<Broken> HardPromises::broken_by(const HardSetting& setting, const HardRun& run) {
  std::vector<Broken> broken;
  if (run.refused) {
    if (run.refused->place.empty()) broken.push_back({"named", "no place"});
    const bool right = row_.must != Must::be_refused || run.refused->place == row_.place;
    if (!right) broken.push_back({"refused", "at " + run.refused->place});
    return broken;
  }
  if (row_.must == Must::be_refused) broken.push_back({"refused", "solved"});
  if (!finite(run)) broken.push_back({"finite", "not all is finite"});
  if (!inside(run)) broken.push_back({"inside", "the picture leaves its constraint"});
  const bool invalid = run.info.health == Health::invalid;
  if (invalid && !all_zero(run.x)) broken.push_back({"invalid", "a picture of an invalid frame"});
  if (row_.must == Must::be_invalid && !invalid) broken.push_back({"invalid", "health says otherwise"});
  const bool minimises = setting.solver->minimises || row_.hard.lambda_share < 1.0;
  if (row_.must == Must::be_zero && minimises && (invalid || !all_zero(run.x))) {
    broken.push_back({"zero", invalid ? "invalid" : "not all is zero"});
  }
  if (judge_ && !invalid) check_value(setting, run, broken);
  return broken;
}

}  // namespace compueye::tests
