#include "recon/lambda_by_risk.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include "hal/try.hpp"
#include "recon/aligned_workspace.hpp"
#include "recon/setup/solver_row.hpp"

namespace compueye::recon {
namespace {

using hal::ErrorCode;
using hal::fail;
using hal::Result;

constexpr double step = 4.0;
constexpr int steps_down = 3, steps_up = 9;
/// The lowest is tried only where the one above it won.
constexpr int sure_steps_down = 2;
constexpr int most_trials = 1 + steps_up + steps_down + 2;
/// Of sigma: large enough for float32 to see, small enough for the picture to follow in proportion.
constexpr double probe_size = 0.3;
/// Both chosen by bench/lambda_rule --family --tuning.
constexpr double standard_errors = 1.0, coefficients_per_channel = 0.3;
constexpr int least_cold_iterations = 60;
/// With fewer, the pictures of a lambda below the rule's are those of iterations that have not got there.
constexpr int least_to_fall = 100;
/// Of the samples' squares.
constexpr double nothing_left = 1e-4;

/// Signs that nothing in an eye's lattice can be correlated with (SplitMix64's finaliser: Steele, Lea & Flood 2014).
double sign_of(std::uint64_t channel) noexcept {
  std::uint64_t z = (channel + 1) * 0x9E3779B97F4A7C15U;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9U;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBU;
  return ((z ^ (z >> 31)) & 1U) != 0 ? 1.0 : -1.0;
}

/// What one picture leaves of the samples.
struct Explained {
  std::vector<double> samples;  ///< A x
  double penalty = 0.0;         ///< ||Psi x||_1
};

class RiskSearch {
 public:
  RiskSearch(const Response& response, const Objective& objective, const Plan& plan, const NoisyFrame& frame,
             std::optional<Factor> factor, const Progress& progress)
      : response_(response),
        objective_(objective),
        plan_(plan),
        frame_(frame),
        weighs_l1_(plan.solver->lambda == LambdaUse::penalty && plan.l1_reweighting == 0.0),
        probed_(frame.y.begin(), frame.y.end()),
        progress_(progress) {
    found_.lambda = objective.lambda;
    found_.factor = std::move(factor);
    falls_ = !plan_.warm_start && plan_.iterations >= least_to_fall;
    if (plan_.warm_start) plan_.iterations = std::max(plan_.iterations, least_cold_iterations);
    plan_.warm_start = false;
    plan_.measure_gap = false;
    for (const std::int32_t row : response.seeing_rows()) {
      const auto m = static_cast<std::size_t>(row);
      const double weight = frame.weights.empty() ? 1.0 : double{frame.weights[m]};
      if (!(weight > 0.0)) continue;
      channels_.push_back({m, weight});
      probed_[m] += static_cast<float>(probe_size * frame.sigma * sign_of(m) / std::sqrt(weight));
    }
    noise_ = static_cast<double>(channels_.size()) * frame.sigma * frame.sigma;
  }

  Result<LambdaByRisk> run() {
    if (!(noise_ > 0.0)) return std::move(found_);
    TRY(try_at(0));
    for (int k = 1; k <= steps_up && !hopeless_; ++k) TRY(try_at(k));
    for (int k = 1; k <= sure_steps_down && falls_; ++k) TRY(try_at(-k));
    for (int k = sure_steps_down + 1; k <= steps_down && best().k == 1 - k; ++k) TRY(try_at(-k));
    const double coarse = best().k;
    if (falls_ || coarse > 0.0) TRY(try_at(coarse - .5));
    TRY(try_at(coarse + .5));
    if (const double misfit = best().trial.misfit / noise_; misfit > most_misfit()) {
      found_.unexplained = std::sqrt(misfit);
    } else {
      found_.lambda = best().trial.lambda;
    }
    for (const Tried& one : tried_) found_.trials.push_back(one.trial);
    return std::move(found_);
  }

 private:
  struct Channel {
    std::size_t row;
    double weight;
  };
  struct Tried {
    double k;
    LambdaTrial trial;
  };

  /// What one standard error of the samples' noise is in risk.
  [[nodiscard]] double slack() const noexcept {
    return weighs_l1_ ? standard_errors * noise_ / std::sqrt(static_cast<double>(channels_.size())) : 0.0;
  }

  /// Over the noise: what a sigma that is known to a third explains, and three standard errors of few channels.
  [[nodiscard]] double most_misfit() const noexcept {
    return std::max(2.0, 1.0 + 3.0 * std::sqrt(2.0 / static_cast<double>(channels_.size())));
  }

  [[nodiscard]] double least_risk() const {
    double least = tried_.front().trial.risk;
    for (const Tried& one : tried_) least = std::min(least, one.trial.risk);
    return least;
  }

  /// Of those whose risk the samples cannot tell from the least, the one with the most evidence.
  [[nodiscard]] const Tried& best() const {
    const double least = least_risk();
    const Tried* best = nullptr;
    for (const Tried& one : tried_) {
      if (one.trial.risk > least + slack()) continue;
      if (best == nullptr || one.trial.surprise < best->trial.surprise) best = &one;
    }
    return *best;
  }

  /// At the start times step^k. What only goes wrong away from the start is left out.
  Result<void> try_at(double k) {
    if (progress_ && !progress_("lambda by risk", static_cast<double>(tried_.size()), most_trials)) {
      return fail(ErrorCode::interrupted, "lambda", "was given up before it was chosen");
    }
    Objective objective = objective_;
    objective.lambda *= std::pow(step, k);
    auto tried = trial(objective, k);
    if (!tried) {
      if (k != 0.0 && tried.error().code != ErrorCode::interrupted) return {};
      return tl::unexpected(std::move(tried.error()));
    }
    tried_.push_back({k, *tried});
    // The misfit grows with lambda, and the risk is at least that.
    hopeless_ = hopeless_ || tried->misfit - noise_ > least_risk() + slack();
    return {};
  }

  Result<LambdaTrial> trial(const Objective& objective, double k) {
    const Progress progress = tried_.empty() ? progress_ : progress_.unestimated();
    auto stored = found_.factor ? factor_that_fits(*found_.factor, response_, objective, plan_) : std::nullopt;
    auto solver = TRY(Reconstructor::create(response_, objective, plan_, std::move(stored), progress));
    if (!found_.factor && reusable_factor() && solver.factor().order > 0) found_.factor = solver.factor();
    const Explained seen = TRY(explained(solver, frame_.y));
    const Explained moved = TRY(explained(solver, probed_));
    double misfit = 0.0, followed = 0.0, left = 0.0, all = 0.0;
    for (const auto& [m, weight] : channels_) {
      const double residual = frame_.y[m] - seen.samples[m];
      misfit += weight * residual * residual;
      left += weight * seen.samples[m] * seen.samples[m];
      all += weight * frame_.y[m] * frame_.y[m];
      followed += std::sqrt(weight) * sign_of(m) * (moved.samples[m] - seen.samples[m]);
    }
    const double freedom =
        std::clamp(followed / (probe_size * frame_.sigma), 0.0, static_cast<double>(channels_.size()));
    const double variance = frame_.sigma * frame_.sigma;
    hopeless_ = left <= nothing_left * all;
    const double risk = misfit - noise_ + 2.0 * variance * freedom;
    const double grown = 2.0 * coefficients_per_channel * noise_ * std::log(step) * k;
    const double surprise = weighs_l1_ ? misfit + 2.0 * objective.lambda * seen.penalty - grown : risk;
    return LambdaTrial{objective.lambda, risk, surprise, misfit};
  }

  [[nodiscard]] bool reusable_factor() const noexcept {
    return uses_factor(plan_.solver) && plan_.solver->rho != RhoUse::lambda && plan_.precision == Precision::f32;
  }

  [[nodiscard]] Result<Explained> explained(const Reconstructor& solver, std::span<const float> y) const {
    const AlignedWorkspace memory(solver.required_bytes());
    std::vector<float> picture(static_cast<std::size_t>(response_.cols()));
    const FrameInfo info = solver.solve(y, frame_.weights, memory.span(), picture);
    if (info.health == Health::invalid) {
      return fail(ErrorCode::out_of_range, "samples", "cannot be solved: one is not finite or far too large");
    }
    Explained result{std::vector<double>(y.size()), 0.0};
    response_.forward(std::vector<double>(picture.begin(), picture.end()), result.samples);
    const double lambda = solver.objective().lambda;
    if (lambda > 0.0) result.penalty = std::max(0.0, info.objective - info.residual * info.residual / 2.0) / lambda;
    return result;
  }

  const Response& response_;
  const Objective& objective_;
  Plan plan_;
  const NoisyFrame& frame_;
  bool weighs_l1_;
  std::vector<float> probed_;
  const Progress& progress_;
  std::vector<Channel> channels_;
  double noise_ = 0.0;  ///< that the channels hold together
  LambdaByRisk found_;
  std::vector<Tried> tried_;
  bool falls_ = false;     ///< lambdas below the start are tried too
  bool hopeless_ = false;  ///< no larger lambda can win
};

}  // namespace

Result<LambdaByRisk> lambda_by_risk(const Response& response, const Objective& objective, const Plan& plan,
                                    const NoisyFrame& frame, std::optional<Factor> factor, const Progress& progress) {
  if (!std::isfinite(frame.sigma) || frame.sigma < 0.0) {
    return fail(ErrorCode::out_of_range, "sigma",
                "is " + std::to_string(frame.sigma) + ", expected a finite number of 0 or more");
  }
  const auto rows = static_cast<std::size_t>(response.rows());
  for (const std::size_t count : {frame.y.size(), frame.weights.empty() ? rows : frame.weights.size()}) {
    if (count == rows) continue;
    return fail(ErrorCode::mismatch, "samples",
                "or weights are " + std::to_string(count) + ", the response has " + std::to_string(rows) + " rows");
  }
  return RiskSearch(response, objective, plan, frame, std::move(factor), progress).run();
}

}  // namespace compueye::recon
