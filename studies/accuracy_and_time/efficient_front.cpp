#include "studies/accuracy_and_time/efficient_front.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace compueye::firmware {

std::vector<std::size_t> efficient_front(std::span<const CostAndError> points, double least_gain) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (std::isfinite(points[i].cost) && std::isfinite(points[i].error)) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return points[a].cost != points[b].cost ? points[a].cost < points[b].cost : points[a].error < points[b].error;
  });
  std::vector<std::size_t> front;
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t i : order) {
    if (!(points[i].error < least * (1.0 - least_gain))) continue;
    least = points[i].error;
    front.push_back(i);
  }
  return front;
}

}  // namespace compueye::firmware
