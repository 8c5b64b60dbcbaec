#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "firmware/eye/board.hpp"
#include "firmware/eye/measured_eye.hpp"
#include "firmware/eye/reconstructor_maker.hpp"
#include "hal/result.hpp"
#include "recon/problem/response.hpp"
#include "recon/reconstructor.hpp"
#include "recon/setup/factor.hpp"

namespace compueye::firmware {

/// The response of a board, measured or nominal, as far as its ommatidia live.
struct LivingResponse {
  recon::Response response;        ///< the rows of dead and masked ommatidia are empty
  std::vector<std::uint8_t> sees;  ///< by ommatidium, 0 = sees nothing or is masked; one that the board calls dead may
  std::shared_ptr<const MeasuredEye> measured = {};  ///< null: it is the nominal one
};

/// That of the board's eye file where it names one. Errors: those of measured_rows() or nominal_response();
/// interrupted.
[[nodiscard]] hal::Result<LivingResponse> living_response(const Board& board, const recon::Progress& progress);

/// The same of another response of the board's eye.
[[nodiscard]] LivingResponse living_response(const Board& board, recon::Response response,
                                             std::shared_ptr<const MeasuredEye> measured = {});

enum class LambdaOrigin : std::uint8_t {
  hand,      ///< the board's or the command line's
  rule,      ///< recon/lambda_rule.hpp
  samples,   ///< recon/lambda_by_risk.hpp
  recording  ///< what the run chose that made it
};
[[nodiscard]] std::string_view name(LambdaOrigin origin) noexcept;

/// Where lambda came from.
struct LambdaChoice {
  double value = 0.0;
  LambdaOrigin origin = LambdaOrigin::hand;
  double sigma = 0.0;  ///< noise of a sample, and
  double rule = 0.0;   ///< the rule's lambda for it; both meaningful unless by hand
};

/// `by_hand` where there is one, else by the rule for this solver and basis from the noise `sigma` of one sample.
/// `white`: of lambda_by_rule(). Errors: those of it.
[[nodiscard]] hal::Result<LambdaChoice> choose_lambda(const recon::Response& response, recon::SolverKind solver,
                                                      recon::BasisKind basis, std::optional<double> by_hand,
                                                      double sigma, double white = 1.0);

/// A board made ready to reconstruct: its living_response(), lambda, the factor (kept or made) and the reconstructor.
class ReadyEye {
 public:
  /// Takes from milliseconds to minutes; `progress` is asked throughout. What takes long is kept in the folder `cache`
  /// (empty: nowhere). Errors: those of living_response(), lambda_by_rule() and Reconstructor::create(); interrupted.
  [[nodiscard]] static hal::Result<ReadyEye> make(const Board& board, const std::string& cache,
                                                  const recon::Progress& progress);
  /// The same on a response that is there already, which only this call looks at.
  [[nodiscard]] static hal::Result<ReadyEye> make(const Board& board, const LivingResponse& living,
                                                  const std::string& cache, const recon::Progress& progress);
  /// The same as one of several reconstructors that `maker` makes of this response, for board.plan.op.
  [[nodiscard]] static hal::Result<ReadyEye> make(const Board& board, const LivingResponse& living,
                                                  ReconstructorMaker& maker, const recon::Progress& progress);

  [[nodiscard]] const recon::Reconstructor& reconstructor() const noexcept { return *reconstructor_; }
  /// Gives the reconstructor away, and with it the right to ask for it.
  [[nodiscard]] recon::Reconstructor take_reconstructor() && { return std::move(*reconstructor_); }
  /// As in LivingResponse.
  [[nodiscard]] const std::vector<std::uint8_t>& sees() const noexcept { return sees_; }
  /// Null: the response is the nominal one.
  [[nodiscard]] const MeasuredEye* measured() const noexcept { return measured_.get(); }
  [[nodiscard]] const LambdaChoice& lambda() const noexcept { return lambda_; }
  [[nodiscard]] FactorOrigin factor_origin() const noexcept { return factor_origin_; }
  [[nodiscard]] const std::vector<std::string>& notes() const noexcept { return notes_; }

  /// Another lambda, on the response that the eye was made of. Errors: those of Reconstructor::create(), and the eye
  /// stays as it was.
  [[nodiscard]] hal::Result<void> set_lambda(const LivingResponse& living, double value, LambdaOrigin origin,
                                             const recon::Progress& progress);
  /// lambda from the samples of one frame (recon/lambda_by_risk.hpp), y and weights as for Reconstructor::solve(),
  /// where it is by rule and weighs an l1 term. Returns why the rule's stays, empty where it does not. Errors:
  /// interrupted.
  [[nodiscard]] hal::Result<std::string> choose_lambda_by(std::span<const float> y, std::span<const float> weights,
                                                          const LivingResponse& living,
                                                          const recon::Progress& progress);
  /// Whether choose_lambda_by() has anything to choose.
  [[nodiscard]] bool takes_lambda_from_samples() const noexcept;
  /// Whether a frame tells of more than noise: its light, which is never negative, adds up to three standard errors.
  [[nodiscard]] bool stands_above_noise(std::span<const float> y, std::span<const float> weights) const noexcept;

  /// Gives back memory that frames do not need, see Reconstructor::forget_modes().
  void forget_modes() noexcept { reconstructor_->forget_modes(); }
  /// Another number of iterations a frame.
  [[nodiscard]] hal::Result<void> set_iterations(int iterations) { return reconstructor_->set_iterations(iterations); }

 private:
  ReadyEye() = default;

  recon::Plan plan_;  // as asked for, its rules not resolved
  std::unique_ptr<recon::Reconstructor> reconstructor_;
  std::vector<std::uint8_t> sees_;
  std::shared_ptr<const MeasuredEye> measured_;
  LambdaChoice lambda_;
  FactorOrigin factor_origin_ = FactorOrigin::made;
  std::vector<std::string> notes_;
};

}  // namespace compueye::firmware
