#pragma once

#include <vector>

#include "calib/estimate/estimate.hpp"
#include "calib/estimate/field_system.hpp"
#include "calib/estimate/shared_fit.hpp"

namespace compueye::calib {

/// What all rows are estimated from. Read by several threads at once.
struct RowTask {
  const LightSamples& samples;
  const ShownPatterns& patterns;
  const EstimateSettings& settings;
  ConePrior prior;
  PlaneError plane;
};

/// Which strengths are tried on every row: those that the sampled rows found common.
struct StrengthsTried {
  std::vector<FieldStrengths> strengths;
  std::vector<double> log_shares;  ///< of each

  /// None at all, alone.
  [[nodiscard]] static StrengthsTried none();
  /// None at all, and the commonest few. `log_likelihoods` as for log_shares().
  [[nodiscard]] static StrengthsTried commonest(const std::vector<std::vector<double>>& log_likelihoods);
};

/// Estimates rows, one after the other. One for each thread.
class RowEstimator {
 public:
  RowEstimator(const hal::EyeGeometry& eye, const hal::ObjectPlane& plane, const RowTask& task)
      : model_(eye, plane), task_(task) {}

  /// Log likelihoods of the patterns held out, by field_strengths(). Empty where the cone sees nothing.
  [[nodiscard]] std::vector<double> score(int channel);

  [[nodiscard]] RowEstimate estimate(int channel, const StrengthsTried& tried);

 private:
  struct Start {
    RowSamples samples;
    ConeFit fit;
    RowSupport support;
    KnotGrid grid;
  };
  [[nodiscard]] Start start(int channel);
  [[nodiscard]] FieldSystem system(const Start& from) const;
  [[nodiscard]] bool fits(const Start& from, double chi2) const;
  [[nodiscard]] bool tells_errors(int channel) const noexcept;
  static void choose(const FieldSystem& fields, const StrengthsTried& tried, RowEstimate& row);
  void fill(int channel, const FieldSystem::Solution& solution, RowEstimate& row);

  SoftCone model_;
  const RowTask& task_;
};

}  // namespace compueye::calib
