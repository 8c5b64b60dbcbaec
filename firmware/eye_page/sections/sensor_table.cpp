#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include "firmware/eye_page/plots/markup.hpp"
#include "firmware/eye_page/plots/spread.hpp"
#include "firmware/eye_page/sections/sections.hpp"
#include "firmware/text/number_text.hpp"

namespace compueye::firmware {
namespace {

/// What people call the figures that estimates have.
struct SensorFigure {
  std::string_view name, words;
};
constexpr std::array<SensorFigure, 9> figures{{{"gain_lsb_per_e", "system gain K, LSB/e"},
                                               {"dark_noise_lsb", "temporal noise in the dark, LSB"},
                                               {"read_noise_e", "temporal noise in the dark, e"},
                                               {"dark_current_e_per_s", "dark current, e/s"},
                                               {"saturation_e", "saturation, e"},
                                               {"linearity_error", "linearity error, share"},
                                               {"dynamic_range", "dynamic range, ratio"},
                                               {"dsnu_e", "DSNU, e"},
                                               {"prnu", "PRNU, share (optics included)"}}};

std::string words_of(const std::string& name) {
  const auto found =
      std::find_if(figures.begin(), figures.end(), [&](const SensorFigure& each) { return each.name == name; });
  return found != figures.end() ? std::string(found->words) : name;
}

constexpr double not_known = std::numeric_limits<double>::quiet_NaN();

std::string told(double value) {
  return std::isfinite(value) ? significant(value, 4) : "not determined";
}

}  // namespace

hal::Result<std::string> sensor_table(const PageData& data) {
  if (!data.newest) return std::string();
  const calib::Estimate& estimate = data.newest->estimate;
  std::vector<std::vector<std::string>> rows;
  const auto column_of = [&](const std::string& name) -> const calib::NamedColumn* {
    const auto& all = estimate.channel_sensor;
    const auto found = std::find_if(all.begin(), all.end(), [&](const auto& each) { return each.name == name; });
    return found != all.end() ? &*found : nullptr;
  };
  const auto add = [&](const std::string& name, const std::string& of_all) {
    const calib::NamedColumn* column = column_of(name);
    const auto spread = column != nullptr ? spread_of(column->values) : std::nullopt;
    const auto each = [&](double Spread::*member) {
      return spread ? significant((*spread).*member, 4) : std::string();
    };
    rows.push_back(
        column == nullptr
            ? std::vector<std::string>{words_of(name), of_all, "", "", "", ""}
            : std::vector<std::string>{words_of(name), of_all, told(spread ? spread->median : not_known),
                                       each(&Spread::low), each(&Spread::high),
                                       fmt::format("{} of {}", spread ? spread->count : 0, estimate.status.size())});
  };
  for (const calib::NamedNumber& number : estimate.sensor) add(number.name, told(number.value));
  for (const calib::NamedColumn& column : estimate.channel_sensor) {
    const auto is = [&](const calib::NamedNumber& number) { return number.name == column.name; };
    if (std::none_of(estimate.sensor.begin(), estimate.sensor.end(), is)) add(column.name, "");
  }
  if (rows.empty()) return std::string();
  return html_table({"figure", "all channels", "median channel", "5 %", "95 %", "channels that tell"}, rows, 5);
}

}  // namespace compueye::firmware
