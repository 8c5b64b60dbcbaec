#include "studies/accuracy_and_time/curve_eyes.hpp"

#include <optional>
#include <utility>

#include "recon/lambda_rule.hpp"
#include "recon/setup/quantised_response.hpp"

namespace compueye::firmware {

Board with_curve(const Board& board, const Curve& curve) {
  Board other = board;
  ReconstructionSettings& settings = other.reconstruction;
  settings.solver = curve.solver;
  settings.basis = curve.basis;
  settings.constraint = curve.constraint;
  settings.op = curve.op;
  settings.warm_start = curve.motion != Motion::none;
  settings.threads = curve.threads;
  // Both were chosen for the board's own solver and basis; rho means the same where solver and metric are the same.
  settings.lambda = std::nullopt;
  if (curve.solver != board.reconstruction.solver ||
      recon::metric_of(curve.basis) != recon::metric_of(board.reconstruction.basis)) {
    settings.rho = std::nullopt;
  }
  return other;
}

hal::Result<CurveEyes> set_up_curve(const Board& board, const LivingResponse& living, const Curve& curve,
                                    const std::vector<NoiseLevel>& levels, const recon::Progress& progress) {
  CurveEyes eyes;
  const Board curved = with_curve(board, curve);
  std::optional<recon::Response> rounded;
  if (curve.op && recon::is_lossy(*curve.op)) rounded = recon::quantised(living.response, *curve.op);
  const recon::Response& a = rounded ? *rounded : living.response;
  // tikhonov's factor goes with its lambda: nothing to share, nothing worth keeping.
  const bool shares = curve.solver != recon::SolverKind::tikhonov;
  for (const NoiseLevel& level : levels) {
    if (eyes.by_level.empty() || !shares) {
      EyeRequest request{std::nullopt, std::nullopt, level.sigma, std::nullopt, {}, curve.precision};
      if (shares) request.cache = board.folder / ".cache";
      auto eye = ReadyEye::make(curved, living, request, progress);
      if (!eye) return tl::unexpected(std::move(eye.error()));
      eyes.lambda.push_back(eye->lambda().value);
      eyes.notes.insert(eyes.notes.end(), eye->notes().begin(), eye->notes().end());
      eyes.by_level.push_back(std::move(*eye).take_reconstructor());
      continue;
    }
    const recon::Reconstructor& first = eyes.by_level.front();
    auto lambda =
        recon::lambda_by_rule(a, board.object.rows, board.object.cols, curve.solver, curve.basis, level.sigma);
    if (!lambda) return tl::unexpected(std::move(lambda.error()));
    recon::Objective objective = first.objective();
    objective.lambda = *lambda;
    recon::Plan plan = first.plan();
    // What followed from lambda follows from this one.
    plan.rho = curved.reconstruction.rho.value_or(0.0);
    if (curve.solver == recon::SolverKind::tsvd) plan.rank = 0;
    // In double a factor is made anew every time: what is kept is in float32.
    std::optional<recon::Factor> factor;
    if (recon::uses_factor(curve.solver) && curve.precision == recon::Precision::f32) factor = first.factor();
    auto made = recon::Reconstructor::create(a, first.image_rows(), first.image_cols(), objective, plan,
                                             std::move(factor), progress);
    if (!made) return tl::unexpected(std::move(made.error()));
    eyes.lambda.push_back(*lambda);
    eyes.by_level.push_back(std::move(*made));
  }
  return eyes;
}

}  // namespace compueye::firmware
