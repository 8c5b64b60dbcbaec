#include "firmware/eye_page/plots/axis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "firmware/text/number_text.hpp"

namespace compueye::firmware {

void Axis::hold(double value) noexcept {
  if (!std::isfinite(value)) return;
  lo = std::min(lo, value);
  hi = std::max(hi, value);
}

void Axis::settle() noexcept {
  if (!(lo <= hi)) lo = hi = 0.0;
  const double middle = 0.5 * (lo + hi);
  double half = 0.5 * (hi - lo) * 1.04;
  if (half <= std::fabs(middle) * 1e-9) half = middle == 0.0 ? 1.0 : 0.05 * std::fabs(middle);
  lo = middle - half;
  hi = middle + half;
}

std::vector<double> Axis::ticks(int wanted) const {
  const double raw = (hi - lo) / wanted;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  double step = 10.0 * power;
  for (const double each : {1.0, 2.0, 5.0}) {
    if (each * power >= raw * (1.0 - 1e-9)) {
      step = each * power;
      break;
    }
  }
  std::vector<double> found;
  constexpr int most = 50;
  for (double k = std::ceil(lo / step); k * step <= hi && static_cast<int>(found.size()) < most; k += 1.0) {
    found.push_back(k * step);
  }
  return found;
}

Axis empty_axis(std::string label) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return {std::move(label), infinity, -infinity};
}

std::string tick_text(double value) {
  constexpr double many = 1e4, whole = 1e9;
  if (std::fabs(value) < 1e-12) return "0";
  if (std::fabs(value) >= many && std::fabs(value) < whole) return grouped(static_cast<std::int64_t>(value));
  return fmt::format("{:.4g}", value);
}

}  // namespace compueye::firmware
