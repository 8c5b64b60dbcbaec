#include "studies/stability/hard_samples.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "sim/random/random.hpp"

namespace compueye::firmware {
namespace {

/// Calls change(m) for a share of the channels.
template <class Change>
void share_of(HardProblem& problem, double share, const Change& change) {
  for (std::size_t m = 0; m < problem.y.size(); ++m) {
    const auto k = static_cast<double>(m);
    if (std::floor((k + 1.0) * share) > std::floor(k * share)) change(m);
  }
}

void masked(HardProblem& problem, double share, float reads) {
  problem.weights.assign(problem.y.size(), 1.0F);
  share_of(problem, share, [&](std::size_t m) {
    problem.y[m] = reads;
    problem.weights[m] = 0.0F;
  });
}

}  // namespace

void all_times(HardProblem& problem, double amount) {
  for (float& value : problem.y) value = static_cast<float>(static_cast<double>(value) * amount);
}

void one_outlier(HardProblem& problem, double amount) {
  problem.y[problem.y.size() / 2] = static_cast<float>(amount * problem.rms);
}

void saturated(HardProblem& problem, double amount) {
  const auto most = static_cast<float>(amount) * *std::max_element(problem.y.begin(), problem.y.end());
  for (float& value : problem.y) value = std::min(value, most);
}

void dead_unknown(HardProblem& problem, double amount) {
  share_of(problem, amount, [&](std::size_t m) { problem.y[m] = 0.0F; });
}

void hot_unknown(HardProblem& problem, double amount) {
  constexpr double hot = 10.0;
  share_of(problem, amount, [&](std::size_t m) { problem.y[m] = static_cast<float>(hot * problem.rms); });
}

void dead_known(HardProblem& problem, double amount) {
  masked(problem, amount, std::numeric_limits<float>::quiet_NaN());
}

void hot_known(HardProblem& problem, double amount) {
  masked(problem, amount, std::numeric_limits<float>::infinity());
}

void weight_spread(HardProblem& problem, double amount) {
  const auto last = static_cast<double>(std::max<std::size_t>(2, problem.y.size()) - 1);
  for (std::size_t m = 0; m < problem.y.size(); ++m) {
    problem.weights.push_back(static_cast<float>(std::pow(amount, static_cast<double>(m) / last)));
  }
}

void one_channel(HardProblem& problem, double) {
  problem.weights.assign(problem.y.size(), 0.0F);
  problem.weights[problem.y.size() / 2] = 1.0F;
}

void unrelated(HardProblem& problem, double amount) {
  sim::RandomStream stream({7, sim::Draws::read_noise, 0, 0});
  for (float& value : problem.y) value = static_cast<float>(amount * problem.rms * stream.gaussian());
}

}  // namespace compueye::firmware
