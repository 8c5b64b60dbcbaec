#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "hal/result.hpp"
#include "recon/problem/plan.hpp"
#include "recon/problem/response.hpp"

namespace compueye::firmware {

/// A problem to be solved: samples in units of y, a truth of 0..1 that made them (not always alone).
struct HardProblem {
  recon::Response a;
  std::vector<double> truth;   ///< N
  std::vector<float> y;        ///< M; anything where the weight is 0
  std::vector<float> weights;  ///< M, or empty: all one
  double rms = 0.0;            ///< of the samples before they were changed
};

/// What becomes of a response; `amount` says how far it goes (studies/stability/hard_responses.hpp).
struct ResponseChange {
  recon::Response (*apply)(const recon::Response& a, double amount) = nullptr;  ///< null: nothing
  double amount = 0.0;
};

/// The same of the samples (studies/stability/hard_samples.hpp).
struct SampleChange {
  void (*apply)(HardProblem& problem, double amount) = nullptr;
  double amount = 0.0;
};

/// One way in which a problem is hard, for any eye.
struct HardCase {
  std::string_view name;                      ///< unique
  std::string_view reason;                    ///< why it is hard: a sentence
  ResponseChange response = {};               ///< of the eye's own
  double snr_db = 40.0;                       ///< rms of a seeing sample over the noise's; infinite: no noise
  SampleChange samples = {};                  ///< of y = A x + n
  double lambda_share = 0.01;                 ///< of lambda_of_zero()
  std::optional<std::uint64_t> picture = {};  ///< seed; nothing: the same as in every other case
};

/// Those that `compueye stability` goes through.
[[nodiscard]] std::span<const HardCase> hard_cases() noexcept;

/// The case of an eye: the same bits for the same seed. Errors: those of Response, for a change that leaves no matrix.
[[nodiscard]] HardProblem pose(const HardCase& hard, const recon::Response& eye, std::uint64_t seed);

/// max |Psi A'W y|: without a constraint, and with one that holds 0, the picture is exactly zero where lambda is as
/// large (not with total variation, which never asks a mean to be zero).
[[nodiscard]] double lambda_of_zero(const HardProblem& problem, recon::BasisKind basis);

}  // namespace compueye::firmware
