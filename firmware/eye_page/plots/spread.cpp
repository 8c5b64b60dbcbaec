#include "firmware/eye_page/plots/spread.hpp"

#include <algorithm>
#include <cmath>

#include "calib/median.hpp"

namespace compueye::firmware {

std::optional<Spread> spread_of(std::vector<double> values) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  if (values.empty()) return std::nullopt;
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    return values[static_cast<std::size_t>(std::lround(share * static_cast<double>(values.size() - 1)))];
  };
  return Spread{at(0.05), calib::median(values), at(0.95), values.size()};
}

}  // namespace compueye::firmware
