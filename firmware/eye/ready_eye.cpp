#include "firmware/eye/ready_eye.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/nominal.hpp"
#include "firmware/text/number_text.hpp"
#include "hal/try.hpp"
#include "recon/aligned_workspace.hpp"
#include "recon/huber_passes.hpp"
#include "recon/lambda_by_risk.hpp"
#include "recon/lambda_rule.hpp"
#include "recon/response_fit.hpp"
#include "recon/setup/rounded_form.hpp"
#include "recon/setup/solver_row.hpp"

namespace compueye::firmware {
namespace {

recon::Response as_applied(const recon::Response& response, const recon::Plan& plan) {
  auto form = recon::rounded_form(response, plan.op);
  return form ? std::move(form->response) : response;
}

/// How many times what noise explains is the least residual of any picture; 0 where that is no misfit.
double misfit_of(const recon::Reconstructor& reconstructor, double sigma, std::span<const float> y,
                 std::span<const float> weights) {
  const recon::AlignedWorkspace workspace(reconstructor.required_bytes());
  std::vector<float> picture(static_cast<std::size_t>(reconstructor.pixels()));
  const recon::FrameInfo info = reconstructor.solve(y, weights, workspace.span(), picture);
  const recon::ResponseFit fit = recon::ResponseFitter(reconstructor, sigma).fit(info, y, weights, picture);
  return fit.misfit() ? fit.least : 0.0;
}

}  // namespace

std::string_view name(LambdaOrigin origin) noexcept {
  switch (origin) {
    case LambdaOrigin::hand:
      return "hand";
    case LambdaOrigin::rule:
      return "rule";
    case LambdaOrigin::samples:
      return "samples";
    case LambdaOrigin::recording:
      return "recording";
  }
  return "hand";
}

hal::Result<LivingResponse> living_response(const Board& board, const recon::Progress& progress) {
  if (board.eye_file.empty()) {
    return living_response(board, TRY(calib::nominal_response(board.eye, board.object, progress)));
  }
  if (progress && !progress("eye file", 0.0, 0.0)) {
    return hal::fail(hal::ErrorCode::interrupted, board.name, "the set-up was stopped");
  }
  MeasuredRows rows = TRY(measured_rows(board, progress));
  return living_response(board, std::move(rows.response), std::make_shared<const MeasuredEye>(std::move(rows.eye)));
}

LivingResponse living_response(const Board& board, recon::Response response,
                               std::shared_ptr<const MeasuredEye> measured) {
  std::vector<std::uint8_t> sees(static_cast<std::size_t>(response.rows()), 0);
  for (const std::int32_t m : response.seeing_rows()) sees[static_cast<std::size_t>(m)] = 1;
  if (!board.sensor.dead.empty()) response = response.without_rows(board.sensor.dead);
  return {std::move(response), std::move(sees), std::move(measured)};
}

hal::Result<LambdaChoice> choose_lambda(const recon::Response& response, recon::SolverKind solver,
                                        recon::BasisKind basis, std::optional<double> by_hand, double sigma,
                                        double white) {
  if (by_hand) return LambdaChoice{*by_hand, LambdaOrigin::hand, 0.0, 0.0};
  const double rule = TRY(recon::lambda_by_rule(response, solver, basis, sigma, white));
  return LambdaChoice{rule, LambdaOrigin::rule, sigma, rule};
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
  eye.measured_ = living.measured;
  recon::Plan plan = board.plan;
  // As many as the correction lets pass, so that no usable frame is too much for the solver; and as many to be found.
  const auto seeing = static_cast<double>(std::count(eye.sees_.begin(), eye.sees_.end(), 1));
  const int missing = static_cast<int>(std::ceil(board.sensor.max_missing_share * seeing + 1e-9));
  plan.max_reweighted = board.find_dead ? 2 * missing : missing;
  if (board.objective.huber) plan.max_reweighted += recon::HuberPasses::room(static_cast<int>(seeing));
  recon::Objective objective = board.objective;
  eye.lambda_ = TRY(choose_lambda(maker.response(), plan.solver, objective.basis, board.lambda, board.noise_sigma()));
  objective.lambda = eye.lambda_.value;
  if (progress && !progress("how A is applied", 0.0, 0.0)) {
    return hal::fail(hal::ErrorCode::interrupted, board.name, "the set-up was stopped");
  }
  eye.reconstructor_ = std::make_unique<recon::Reconstructor>(TRY(maker.make(objective, plan, progress)));
  eye.plan_ = plan;
  eye.factor_origin_ = maker.origin();
  eye.notes_ = maker.notes();
  return eye;
}

hal::Result<void> ReadyEye::set_lambda(const LivingResponse& living, double value, LambdaOrigin origin,
                                       const recon::Progress& progress) {
  recon::Objective objective = reconstructor_->objective();
  objective.lambda = value;
  recon::Plan plan = plan_;
  plan.iterations = reconstructor_->plan().iterations;
  const recon::Response applied = as_applied(living.response, plan);
  auto made = TRY(recon::Reconstructor::create(
      applied, objective, plan, recon::factor_that_fits(reconstructor_->factor(), applied, objective, plan), progress));
  *reconstructor_ = std::move(made);
  lambda_.value = value;
  lambda_.origin = origin;
  return {};
}

bool ReadyEye::takes_lambda_from_samples() const noexcept {
  return lambda_.origin == LambdaOrigin::rule && lambda_.sigma > 0.0 &&
         plan_.solver->lambda == recon::LambdaUse::penalty && !reconstructor_->objective().epsilon;
}

bool ReadyEye::stands_above_noise(std::span<const float> y, std::span<const float> weights) const noexcept {
  constexpr double standard_errors = 3.0;
  double light = 0.0, channels = 0.0;
  for (std::size_t m = 0; m < sees_.size(); ++m) {
    if (sees_[m] == 0 || !(weights[m] > 0.0F)) continue;
    light += double{weights[m]} * double{y[m]};
    channels += double{weights[m]};
  }
  return light > standard_errors * lambda_.sigma * std::sqrt(channels);
}

hal::Result<std::string> ReadyEye::choose_lambda_by(std::span<const float> y, std::span<const float> weights,
                                                    const LivingResponse& living, const recon::Progress& progress) {
  if (const double misfit = misfit_of(*reconstructor_, fit_sigma(lambda_.sigma, measured()), y, weights);
      misfit > 0.0) {
    return "the response does not explain the samples, whose residual is " + significant(misfit, 3) +
           " times what noise does";
  }
  const recon::Response applied = as_applied(living.response, plan_);
  recon::Plan plan = plan_;
  // In double every trial would make a factor.
  plan.precision = recon::Precision::f32;
  auto found = recon::lambda_by_risk(applied, reconstructor_->objective(), plan, {y, weights, lambda_.sigma},
                                     reconstructor_->factor(), progress);
  const auto given_up = [](const hal::Error& error) { return error.code == hal::ErrorCode::interrupted; };
  if (!found) {
    if (given_up(found.error())) return tl::unexpected(std::move(found.error()));
    return found.error().text();
  }
  if (found->unexplained > 0.0) {
    return "pictures of so many iterations leave " + significant(found->unexplained, 3) + " times what noise does";
  }
  auto set = set_lambda(living, found->lambda, LambdaOrigin::samples, progress);
  if (set) return std::string();
  if (given_up(set.error())) return tl::unexpected(std::move(set.error()));
  return set.error().text();
}

}  // namespace compueye::firmware
