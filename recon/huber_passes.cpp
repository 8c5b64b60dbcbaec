#include "recon/huber_passes.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace compueye::recon {

void HuberPasses::take(std::span<const float> given) noexcept {
  for (std::size_t m = 0; m < weights_.size(); ++m) weights_[m] = given_to(given, m);
}

float HuberPasses::least_outlier(std::span<const float> given) noexcept {
  const auto delta = static_cast<float>(delta_);
  std::size_t outliers = 0, taken = 0;
  for (std::size_t m = 0; m < weights_.size(); ++m) {
    if (given_to(given, m) != 1.0F) {
      ++taken;
    } else if (const float size = std::abs(residuals_[m]); size > delta) {
      sizes_[outliers++] = size;
    }
  }
  const std::size_t room = most_weighted_ - std::min(most_weighted_, taken);
  if (outliers <= room) return delta;
  if (room == 0) return std::numeric_limits<float>::infinity();
  std::nth_element(sizes_.begin(), sizes_.begin() + static_cast<std::ptrdiff_t>(room),
                   sizes_.begin() + static_cast<std::ptrdiff_t>(outliers), std::greater<>());
  return sizes_[room];
}

bool HuberPasses::reweigh(std::span<const float> given) noexcept {
  const float least = least_outlier(given);
  bool stands = least == static_cast<float>(delta_);
  for (std::size_t m = 0; m < weights_.size(); ++m) {
    const float own = given_to(given, m), size = std::abs(residuals_[m]);
    const bool reduced = size > (own == 1.0F ? least : static_cast<float>(delta_));
    const float weight = reduced ? own * static_cast<float>(delta_ / static_cast<double>(size)) : own;
    stands = stands && std::abs(weight - weights_[m]) <= still * std::max(weight, weights_[m]);
    weights_[m] = weight;
  }
  return stands;
}

double HuberPasses::objective_of(std::span<const float> given, const FrameInfo& info) const noexcept {
  constexpr double told = 1e-12;
  const double squares = 0.5 * info.residual * info.residual, bent = data_term(given);
  // Beside the square of an outlier that there was no room for, the penalty is lost in rounding.
  const double penalty = info.objective - squares > told * info.objective ? info.objective - squares : 0.0;
  return bent + penalty;
}

double HuberPasses::data_term(std::span<const float> given) const noexcept {
  double sum = 0.0;
  for (std::size_t m = 0; m < weights_.size(); ++m) {
    const double size = std::abs(static_cast<double>(residuals_[m]));
    const double value = size > delta_ ? delta_ * (size - 0.5 * delta_) : 0.5 * size * size;
    sum += static_cast<double>(given_to(given, m)) * value;
  }
  return sum;
}

}  // namespace compueye::recon
