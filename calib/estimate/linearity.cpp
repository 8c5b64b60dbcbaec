#include "calib/estimate/linearity.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

namespace compueye::calib {
namespace {

constexpr int points = 33;

/// q of one channel, where it can be told.
std::optional<double> bow_of(std::span<const SplitWhite> splits, double black, std::size_t channel) {
  double by_lever = 0.0, levers = 0.0, squares = 0.0;
  int count = 0;
  const auto look = [&](auto&& use) {
    for (const SplitWhite& split : splits) {
      const double part = split.part[channel], rest = split.rest[channel], whole = split.whole[channel];
      const double lever = 2.0 * (part - black) * (rest - black), excess = part + rest - whole - black;
      if (std::isfinite(lever) && std::isfinite(excess)) use(lever, excess);
    }
  };
  look([&](double lever, double excess) {
    by_lever += lever * excess;
    levers += lever * lever;
    ++count;
  });
  if (count < 3 || !(levers > 0.0)) return std::nullopt;
  const double q = by_lever / levers;
  look([&](double lever, double excess) { squares += std::pow(excess - q * lever, 2); });
  const double error = std::sqrt(squares / (count - 1) / levers);
  constexpr double errors = 3.0;
  return std::fabs(q) > errors * error ? std::optional(q) : std::nullopt;
}

/// v of code = v + q v (F - v), the root that is the code where q is 0.
double straightened(double code, double q, double largest) noexcept {
  const double slope = 1.0 + q * largest;
  return 2.0 * code / (slope + std::sqrt(std::max(slope * slope - 4.0 * q * code, 0.0)));
}

}  // namespace

std::vector<LinearityTable> linearity_tables(std::span<const SplitWhite> splits, std::span<const double> black,
                                             double largest_code) {
  std::vector<LinearityTable> tables;
  bool any = false;
  for (std::size_t channel = 0; channel < black.size(); ++channel) {
    const std::optional<double> q = bow_of(splits, black[channel], channel);
    // A bow of a quarter of the range is none that a converter has.
    const bool told = q && std::fabs(*q) * largest_code < 0.25;
    any = any || told;
    LinearityTable& table = tables.emplace_back();
    for (int k = 0; k < points; ++k) {
      const double code = largest_code * k / (points - 1);
      table.code.push_back(code);
      table.straight.push_back(told ? straightened(code, *q, largest_code) : code);
    }
  }
  if (!any) tables.clear();
  return tables;
}

}  // namespace compueye::calib
