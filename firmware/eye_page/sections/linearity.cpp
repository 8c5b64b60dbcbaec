#include <fmt/format.h>

#include <cmath>

#include "firmware/eye_page/plots/curve_plot.hpp"
#include "firmware/eye_page/plots/markup.hpp"
#include "firmware/eye_page/sections/sections.hpp"
#include "firmware/text/number_text.hpp"

namespace compueye::firmware {

hal::Result<std::string> linearity_curve(const PageData& data) {
  if (!data.newest || data.newest->estimate.linearity_codes.empty()) return std::string();
  const calib::Estimate& estimate = data.newest->estimate;
  const std::size_t points = estimate.linearity_codes.size();
  SpreadCurve curve{"median channel", {}, {}, true};
  double worst = 0.0, at = 0.0;
  for (std::size_t k = 0; k < points; ++k) {
    std::vector<double> off;
    for (std::size_t m = 0; m < estimate.status.size(); ++m) {
      if (estimate.status[m] != hal::ChannelStatus::good) continue;
      off.push_back(estimate.linearity_codes[k] - estimate.linearity_values[m * points + k]);
    }
    const auto spread = spread_of(std::move(off));
    if (!spread) return std::string();
    curve.x.push_back(estimate.linearity_codes[k]);
    curve.y.push_back(*spread);
    if (std::abs(spread->median) >= std::abs(worst)) {
      worst = spread->median;
      at = estimate.linearity_codes[k];
    }
  }
  const std::string about = worst == 0.0
                                ? std::string("the median channel is straight")
                                : fmt::format("the median channel is off a straight line by at most {} LSB, at code {}",
                                              significant(worst, 3), tick_text(at));
  return curve_plot("linearity-curve", about, empty_axis("code, LSB"), empty_axis("off a straight line, LSB"),
                    {curve}) +
         figures_line(about);
}

}  // namespace compueye::firmware
