#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace compueye::firmware {

/// What a point costs and what it is worth: less of each is better.
struct CostAndError {
  double cost = 0.0;
  double error = 0.0;
};

/// The efficient points' indices in order of rising cost, hence of falling error: each errs by more than `least_gain`
/// of its error (0 = any gain) less than every point that costs no more. Of equal points the first counts. A point with
/// a NaN or an infinity is never efficient and outdoes nobody.
[[nodiscard]] std::vector<std::size_t> efficient_front(std::span<const CostAndError> points, double least_gain = 0.0);

}  // namespace compueye::firmware
