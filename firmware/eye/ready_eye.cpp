#include "firmware/eye/ready_eye.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "recon/lambda_rule.hpp"
#include "recon/setup/quantised_response.hpp"

namespace compueye::firmware {
namespace {

hal::Result<LambdaChoice> choose_lambda(const Board& board, const EyeRequest& request,
                                        const recon::Response& response) {
  const ReconstructionSettings& settings = board.reconstruction;
  if (request.lambda) return LambdaChoice{*request.lambda, false, 0.0};
  if (settings.lambda && !request.sigma) return LambdaChoice{*settings.lambda, false, 0.0};
  const double sigma = request.sigma.value_or(board.noise_sigma());
  return recon::lambda_by_rule(response, board.object.rows, board.object.cols, settings.solver, settings.basis, sigma)
      .map([&](double lambda) {
        return LambdaChoice{lambda, true, sigma};
      });
}

recon::Plan plan_of(const Board& board, const EyeRequest& request, std::int64_t seeing) {
  recon::Plan plan;
  plan.solver = board.reconstruction.solver;
  plan.precision = request.precision;
  plan.iterations = request.iterations.value_or(board.reconstruction.iterations);
  plan.rho = board.reconstruction.rho.value_or(0.0);
  plan.relaxation = board.reconstruction.relaxation;
  plan.op = board.reconstruction.op;
  plan.warm_start = board.reconstruction.warm_start;
  plan.threads = request.threads.value_or(board.reconstruction.threads);
  // As many as the correction lets pass, so that no usable frame is too much for the solver.
  plan.max_reweighted =
      static_cast<int>(std::ceil(board.sensor.max_missing_share * static_cast<double>(seeing) + 1e-9));
  return plan;
}

recon::Objective objective_of(const Board& board, double lambda) {
  const ReconstructionSettings& settings = board.reconstruction;
  return {settings.basis, settings.constraint, settings.box_lo, settings.box_hi, lambda};
}

}  // namespace

hal::Result<ReadyEye> ReadyEye::make(const Board& board, const EyeRequest& request, const recon::Progress& progress) {
  const auto living = living_response(board, progress);
  if (!living) return tl::unexpected(living.error());
  return make(board, *living, request, progress);
}

hal::Result<ReadyEye> ReadyEye::make(const Board& board, const LivingResponse& living, const EyeRequest& request,
                                     const recon::Progress& progress) {
  ReadyEye eye;
  eye.sees_ = living.sees;
  std::optional<recon::Response> rounded;
  if (board.reconstruction.op && recon::is_lossy(*board.reconstruction.op)) {
    // The factor is kept under the hash of the matrix that it belongs to.
    rounded = recon::quantised(living.response, *board.reconstruction.op);
  }
  const recon::Response& a = rounded ? *rounded : living.response;
  if (progress && !progress("lambda by rule", 0.0, 0.0)) {
    return hal::fail(hal::ErrorCode::interrupted, board.name, "the set-up was stopped");
  }
  auto lambda = choose_lambda(board, request, a);
  if (!lambda) return tl::unexpected(std::move(lambda.error()));
  eye.lambda_ = *lambda;

  const recon::Objective objective = objective_of(board, lambda->value);
  const recon::Plan plan = plan_of(board, request, std::count(eye.sees_.begin(), eye.sees_.end(), 1));
  const bool cached = recon::uses_factor(plan.solver) && plan.precision == recon::Precision::f32;
  const recon::Factor wanted =
      recon::Reconstructor::wanted_factor(a, board.object.rows, board.object.cols, objective, plan);
  KeptFactor factor(cached ? request.cache : std::filesystem::path{},
                    {a.content_hash(), wanted.rho, wanted.order, wanted.metric, wanted.rank});
  auto made =
      recon::Reconstructor::create(a, board.object.rows, board.object.cols, objective, plan, factor.take(), progress);
  if (!made) return tl::unexpected(std::move(made.error()));
  eye.reconstructor_ = std::make_unique<recon::Reconstructor>(std::move(*made));
  if (cached && factor.origin() != FactorOrigin::kept) factor.keep(eye.reconstructor_->factor());
  eye.factor_origin_ = factor.origin();
  eye.notes_ = factor.notes();
  return eye;
}

}  // namespace compueye::firmware
