#include "calib/estimate/channel_status.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace compueye::calib {

std::string_view name(ChannelStatus status) noexcept {
  switch (status) {
    case ChannelStatus::good:
      return "good";
    case ChannelStatus::blind:
      return "blind";
    case ChannelStatus::dead:
      return "dead";
    case ChannelStatus::hot:
      return "hot";
    case ChannelStatus::noisy:
      return "noisy";
    case ChannelStatus::saturated:
      return "saturated";
    case ChannelStatus::does_not_fit:
      return "does_not_fit";
  }
  return "";
}

double median(std::vector<double> values) noexcept {
  std::erase_if(values, [](double value) { return std::isnan(value); });
  if (values.empty()) return 0.0;
  const std::size_t half = values.size() / 2;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(half);
  std::nth_element(values.begin(), middle, values.end());
  const double upper = *middle;
  if (values.size() % 2 == 1) return upper;
  return 0.5 * (upper + *std::max_element(values.begin(), middle));
}

}  // namespace compueye::calib
