#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "firmware/eye_page/plots/channel_map.hpp"
#include "firmware/eye_page/plots/markup.hpp"
#include "firmware/eye_page/plots/spread.hpp"
#include "firmware/eye_page/sections/sections.hpp"
#include "firmware/text/number_text.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using hal::Result;

ChannelMap map_of(const PageData& data, std::vector<double> values, std::string label) {
  const calib::Estimate& estimate = data.newest->estimate;
  // What is masked has figures too, but none that a picture depends on.
  for (std::size_t m = 0; m < values.size(); ++m) {
    if (estimate.status[m] != hal::ChannelStatus::good) values[m] = std::numeric_limits<double>::quiet_NaN();
  }
  const hal::EyeGeometry& eye = data.eye.geometry;
  return {eye.rows, eye.columns, std::move(values), estimate.status, std::move(label)};
}

Result<std::string> toned(const std::string& id, const std::string& what, const std::string& unit,
                          const ChannelMap& map) {
  const auto spread = spread_of(map.values);
  if (!spread) return std::string();
  const std::string about = fmt::format("{}: median {}{}, nine tenths of {} ommatidia from {}{} to {}{}", what,
                                        significant(spread->median, 3), unit, spread->count,
                                        significant(spread->low, 3), unit, significant(spread->high, 3), unit);
  return TRY(channel_map(id, about, map)) + figures_line(about);
}

}  // namespace

Result<std::string> channel_states(const PageData& data) {
  if (!data.newest) return std::string();
  const auto& status = data.newest->estimate.status;
  const auto good = std::count(status.begin(), status.end(), hal::ChannelStatus::good);
  return channel_map("channel-map", fmt::format("{} of {} channels are good", good, status.size()),
                     map_of(data, {}, {}));
}

Result<std::string> row_error_map(const PageData& data) {
  if (!data.newest || data.newest->rows.sigma.empty()) return std::string();
  std::vector<double> percent;
  for (const double each : data.newest->row_error) percent.push_back(100.0 * each);
  return toned("row-error-map", "row error", " %", map_of(data, std::move(percent), "row error, %"));
}

Result<std::string> chi2_map(const PageData& data) {
  if (!data.newest || data.newest->estimate.chi2.empty()) return std::string();
  return toned("chi2-map", "chi^2", "", map_of(data, data.newest->estimate.chi2, "chi^2 a point"));
}

}  // namespace compueye::firmware
