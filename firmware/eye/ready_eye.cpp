#include "firmware/eye/ready_eye.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/nominal.hpp"
#include "hal/try.hpp"
#include "recon/lambda_rule.hpp"

namespace compueye::firmware {

hal::Result<LivingResponse> living_response(const Board& board, const recon::Progress& progress) {
  recon::Response response = TRY(calib::nominal_response(board.eye, board.object, progress));
  std::vector<std::uint8_t> sees(static_cast<std::size_t>(response.rows()), 0);
  for (const std::int32_t m : response.seeing_rows()) sees[static_cast<std::size_t>(m)] = 1;
  if (!board.sensor.dead.empty()) response = response.without_rows(board.sensor.dead);
  return LivingResponse{std::move(response), std::move(sees)};
}

hal::Result<LambdaChoice> choose_lambda(const recon::Response& response, recon::SolverKind solver,
                                        recon::BasisKind basis, std::optional<double> by_hand, double sigma) {
  if (by_hand) return LambdaChoice{*by_hand, false, 0.0};
  return LambdaChoice{TRY(recon::lambda_by_rule(response, solver, basis, sigma)), true, sigma};
}

hal::Result<ReadyEye> ReadyEye::make(const Board& board, const std::string& cache, const recon::Progress& progress) {
  return make(board, TRY(living_response(board, progress)), cache, progress);
}

hal::Result<ReadyEye> ReadyEye::make(const Board& board, const LivingResponse& living, const std::string& cache,
                                     const recon::Progress& progress) {
  ReconstructorMaker maker(living.response, board.plan.op, cache);
  return make(board, living, maker, progress);
}

hal::Result<ReadyEye> ReadyEye::make(const Board& board, const LivingResponse& living, ReconstructorMaker& maker,
                                     const recon::Progress& progress) {
  ReadyEye eye;
  eye.sees_ = living.sees;
  recon::Plan plan = board.plan;
  // As many as the correction lets pass, so that no usable frame is too much for the solver; and as many to be found.
  const auto seeing = static_cast<double>(std::count(eye.sees_.begin(), eye.sees_.end(), 1));
  const int missing = static_cast<int>(std::ceil(board.sensor.max_missing_share * seeing + 1e-9));
  plan.max_reweighted = board.find_dead ? 2 * missing : missing;
  recon::Objective objective = board.objective;
  eye.lambda_ = TRY(choose_lambda(maker.response(), plan.solver, objective.basis, board.lambda, board.noise_sigma()));
  objective.lambda = eye.lambda_.value;
  if (progress && !progress("how A is applied", 0.0, 0.0)) {
    return hal::fail(hal::ErrorCode::interrupted, board.name, "the set-up was stopped");
  }
  eye.reconstructor_ = std::make_unique<recon::Reconstructor>(TRY(maker.make(objective, plan, progress)));
  eye.factor_origin_ = maker.origin();
  eye.notes_ = maker.notes();
  return eye;
}

}  // namespace compueye::firmware
