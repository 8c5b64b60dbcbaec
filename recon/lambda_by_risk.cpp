#include "recon/lambda_by_risk.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include "recon/aligned_workspace.hpp"
#include "recon/setup/solver_row.hpp"

namespace compueye::recon {
namespace {

using hal::ErrorCode;
using hal::fail;
using hal::Result;

/// Upwards more than down: the rule errs on the small side, for the sake of pictures that are not sparse.
constexpr std::array factors{1.0, 0.25, 4.0, 16.0, 64.0, 256.0};
/// Of sigma: large enough for float32 to see, small enough for the picture to follow in proportion.
constexpr double probe_size = 0.3;
constexpr double standard_errors = 2.0;

/// Signs that nothing in an eye's lattice can be correlated with (SplitMix64's finaliser: Steele, Lea & Flood 2014).
float sign_of(std::uint64_t channel) noexcept {
  std::uint64_t z = (channel + 1) * 0x9E3779B97F4A7C15U;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9U;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBU;
  return ((z ^ (z >> 31)) & 1U) != 0 ? 1.0F : -1.0F;
}

class RiskSearch {
 public:
  RiskSearch(const Response& response, const Plan& plan, std::span<const float> y, double sigma,
             std::optional<Factor> factor, const Progress& progress)
      : response_(response),
        plan_(plan),
        y_(y),
        sigma_(sigma),
        seeing_(response.seeing_rows()),
        factor_(std::move(factor)),
        progress_(progress) {
    for (std::size_t m = 0; m < y.size(); ++m) {
      probed_.push_back(y[m] + static_cast<float>(probe_size * sigma) * sign_of(m));
    }
  }

  Result<LambdaByRisk> run(Objective objective) {
    LambdaByRisk found{objective.lambda, {}, std::nullopt};
    for (const double factor : factors) {
      objective.lambda = found.lambda * factor;
      if (auto tried = try_at(objective, found); !tried) return tl::unexpected(std::move(tried.error()));
    }
    const LambdaTrial best = *std::min_element(found.trials.begin(), found.trials.end(),
                                               [](const auto& a, const auto& b) { return a.risk < b.risk; });
    const double noise = sigma_ * sigma_ * std::sqrt(static_cast<double>(seeing_.size()));
    if (found.trials.front().risk - best.risk > standard_errors * noise) found.lambda = best.lambda;
    found.factor = std::move(factor_);
    return found;
  }

 private:
  Result<void> try_at(const Objective& objective, LambdaByRisk& found) {
    const auto tried = static_cast<double>(found.trials.size());
    if (progress_ && !progress_("lambda by risk", tried, factors.size())) {
      return fail(ErrorCode::interrupted, "lambda", "was given up before it was chosen");
    }
    auto solver = Reconstructor::create(response_, objective, plan_, factor_, progress_);
    if (!solver) return tl::unexpected(std::move(solver.error()));
    if (!factor_ && reusable_factor()) factor_ = solver->factor();
    const auto seen = samples_of(*solver, y_), moved = samples_of(*solver, probed_);
    if (!seen) return tl::unexpected(seen.error());
    if (!moved) return tl::unexpected(moved.error());
    double misfit = 0.0, followed = 0.0;
    for (const std::int32_t row : seeing_) {
      const auto m = static_cast<std::size_t>(row);
      const double residual = y_[m] - (*seen)[m];
      misfit += residual * residual;
      followed += sign_of(m) * ((*moved)[m] - (*seen)[m]);
    }
    const double variance = sigma_ * sigma_;
    const double freedom = followed / (probe_size * sigma_);
    found.trials.push_back(
        {objective.lambda, misfit + variance * (2.0 * freedom - static_cast<double>(seeing_.size()))});
    return {};
  }

  /// A factor may go with its lambda, and that of double precision is not kept.
  [[nodiscard]] bool reusable_factor() const noexcept {
    return uses_factor(plan_.solver) && plan_.solver->rho != RhoUse::lambda && plan_.precision == Precision::f32;
  }

  /// A x of the picture that the samples give.
  [[nodiscard]] Result<std::vector<double>> samples_of(const Reconstructor& solver, std::span<const float> y) const {
    const AlignedWorkspace memory(solver.required_bytes());
    std::vector<float> picture(static_cast<std::size_t>(response_.cols()));
    if (solver.solve(y, {}, memory.span(), picture).health == Health::invalid) {
      return fail(ErrorCode::out_of_range, "samples", "cannot be solved: one is not finite or far too large");
    }
    const std::vector<double> x(picture.begin(), picture.end());
    std::vector<double> samples(y.size());
    response_.forward(x, samples);
    return samples;
  }

  const Response& response_;
  const Plan& plan_;
  std::span<const float> y_;
  double sigma_;
  std::vector<std::int32_t> seeing_;
  std::optional<Factor> factor_;
  const Progress& progress_;
  std::vector<float> probed_;
};

}  // namespace

Result<LambdaByRisk> lambda_by_risk(const Response& response, const Objective& objective, const Plan& plan,
                                    std::span<const float> y, double sigma, std::optional<Factor> factor,
                                    const Progress& progress) {
  if (!std::isfinite(sigma) || sigma < 0.0) {
    return fail(ErrorCode::out_of_range, "sigma",
                "is " + std::to_string(sigma) + ", expected a finite number of 0 or more");
  }
  if (y.size() != static_cast<std::size_t>(response.rows())) {
    return fail(ErrorCode::mismatch, "samples",
                "are " + std::to_string(y.size()) + ", the response has " + std::to_string(response.rows()) + " rows");
  }
  if (sigma == 0.0) return LambdaByRisk{objective.lambda, {}, std::move(factor)};
  return RiskSearch(response, plan, y, sigma, std::move(factor), progress).run(objective);
}

}  // namespace compueye::recon
