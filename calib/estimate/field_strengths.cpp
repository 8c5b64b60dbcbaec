#include "calib/estimate/field_strengths.hpp"

#include <algorithm>
#include <cmath>

namespace compueye::calib {
namespace {

constexpr std::array sensitivities{0.01, 0.03, 0.1};
constexpr std::array edges{0.01, 0.03, 0.1};
constexpr std::array halos{0.003, 0.01};
constexpr std::size_t tried = 1 + sensitivities.size() * edges.size() * halos.size();

constexpr std::array<FieldStrengths, tried> all_strengths() {
  std::array<FieldStrengths, tried> all{};
  std::size_t at = 1;
  for (const double sensitivity : sensitivities) {
    for (const double edge : edges) {
      for (const double halo : halos) all[at++] = {sensitivity, edge, halo};
    }
  }
  return all;
}
constexpr std::array<FieldStrengths, tried> all = all_strengths();

constexpr int most_passes = 200;
constexpr double least_share = 1e-4;  // of the most common one: nothing is ruled out by the rows that were looked at

}  // namespace

std::span<const FieldStrengths> field_strengths() noexcept {
  return all;
}

std::vector<double> log_shares(const std::vector<std::vector<double>>& log_likelihoods) {
  const std::size_t choices = all.size();
  std::vector<double> shares(choices, 1.0 / static_cast<double>(choices));
  std::vector<double> next(choices), posterior(choices);
  for (int pass = 0; pass < most_passes && !log_likelihoods.empty(); ++pass) {
    std::fill(next.begin(), next.end(), 0.0);
    for (const std::vector<double>& row : log_likelihoods) {
      const double best = *std::max_element(row.begin(), row.end());
      double sum = 0.0;
      for (std::size_t c = 0; c < choices; ++c) sum += posterior[c] = shares[c] * std::exp(row[c] - best);
      for (std::size_t c = 0; c < choices; ++c) {
        next[c] += posterior[c] / sum / static_cast<double>(log_likelihoods.size());
      }
    }
    shares.swap(next);
  }
  const double floor = least_share * *std::max_element(shares.begin(), shares.end());
  for (double& share : shares) share = std::log(std::max(share, floor));
  return shares;
}

}  // namespace compueye::calib
