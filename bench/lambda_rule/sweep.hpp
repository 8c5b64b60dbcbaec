#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bench/lambda_rule/cases.hpp"
#include "hal/image.hpp"
#include "recon/problem/response.hpp"

namespace compueye::bench {

/// One noisy picture solved at many lambdas.
struct Sweep {
  std::string scene;
  std::uint64_t seed = 0;
  double sigma = 0.0;
  std::vector<double> multiples;  ///< of the rule's lambda
  std::vector<double> nmse;       ///< at each of them
  double at_rule = 0.0;           ///< NMSE
  double by_risk = 0.0;           ///< NMSE at the lambda that lambda_by_risk() takes
  double risk_multiple = 1.0;     ///< and that lambda, over the rule's
  double debiased = 0.0;          ///< NMSE after the rule's picture went through debiased(); pixels only
  double reweighted = 0.0;        ///< with reweighted() at the rule's lambda

  [[nodiscard]] double best() const;
  [[nodiscard]] double best_multiple() const;
};

/// An eye of a case, its factor kept over all lambdas.
class SweptEye {
 public:
  explicit SweptEye(const Case& c);

  /// Light through sim's optics for a drawn response, y = A x for a measured one (sim knows no build errors), then
  /// read noise.
  [[nodiscard]] Sweep sweep(const std::string& scene, std::uint64_t seed, double sigma, bool with_risk);

  /// NMSE at the rule's lambda alone.
  [[nodiscard]] double nmse_by_rule(const std::string& scene, std::uint64_t seed, double sigma);

 private:
  [[nodiscard]] double rule(double sigma) const;
  [[nodiscard]] std::vector<float> samples(const std::string& scene, const hal::Image& truth, std::uint64_t seed,
                                           double sigma) const;
  [[nodiscard]] double nmse_at(double lambda, const std::vector<float>& y, const hal::Image& truth);
  [[nodiscard]] recon::Objective objective(double lambda) const;
  [[nodiscard]] recon::Plan plan() const;

  const Case& case_;
  recon::Response response_;
  std::optional<recon::Factor> factor_;
};

}  // namespace compueye::bench
