#include "firmware/app/pareto/curve_eyes.hpp"

#include <optional>
#include <utility>

#include "recon/lambda_rule.hpp"

namespace compueye::firmware {

Board with_curve(const Board& board, const Curve& curve) {
  Board other = board;
  ReconstructionSettings& settings = other.reconstruction;
  settings.solver = curve.solver;
  settings.basis = curve.basis;
  settings.constraint = curve.constraint;
  // Both were chosen for the board's own solver and basis; rho follows the metric.
  settings.lambda = std::nullopt;
  if (!recon::uses_factor(curve.solver) || curve.solver == recon::SolverKind::tikhonov ||
      recon::metric_of(curve.basis) != recon::metric_of(board.reconstruction.basis)) {
    settings.rho = std::nullopt;
  }
  return other;
}

hal::Result<CurveEyes> set_up_curve(const Board& board, const LivingResponse& living, const Curve& curve,
                                    const std::vector<NoiseLevel>& levels, const recon::Progress& progress) {
  CurveEyes eyes;
  const Board curved = with_curve(board, curve);
  // tikhonov's factor goes with its lambda: nothing to share, nothing worth keeping.
  const bool shares = curve.solver != recon::SolverKind::tikhonov;
  for (const NoiseLevel& level : levels) {
    if (eyes.by_level.empty() || !shares) {
      EyeRequest request{std::nullopt, std::nullopt, level.sigma, {}, curve.precision};
      if (shares) request.cache = board.folder / ".cache";
      auto eye = ReadyEye::make(curved, living, request, progress);
      if (!eye) return tl::unexpected(std::move(eye.error()));
      eyes.lambda.push_back(eye->lambda().value);
      eyes.notes.insert(eyes.notes.end(), eye->notes().begin(), eye->notes().end());
      eyes.by_level.push_back(std::move(*eye).take_reconstructor());
      continue;
    }
    const recon::Reconstructor& first = eyes.by_level.front();
    auto lambda = recon::lambda_by_rule(living.response, board.object.rows, board.object.cols, curve.solver,
                                        curve.basis, level.sigma);
    if (!lambda) return tl::unexpected(std::move(lambda.error()));
    recon::Objective objective = first.objective();
    objective.lambda = *lambda;
    recon::Plan plan = first.plan();
    // What followed from lambda follows from this one.
    if (curve.solver == recon::SolverKind::tsvd) plan.rank = 0;
    std::optional<recon::Factor> factor;
    if (!first.factor().inverse.empty()) factor = first.factor();
    auto made = recon::Reconstructor::create(living.response, first.image_rows(), first.image_cols(), objective, plan,
                                             std::move(factor), progress);
    if (!made) return tl::unexpected(std::move(made.error()));
    eyes.lambda.push_back(*lambda);
    eyes.by_level.push_back(std::move(*made));
  }
  return eyes;
}

}  // namespace compueye::firmware
