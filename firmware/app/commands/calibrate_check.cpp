#include "firmware/app/commands/calibrate_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace compueye::firmware {
namespace {

constexpr double degrees = 180.0 / std::numbers::pi;

double turn_deg(const calib::EyeChange& change) {
  return std::hypot(change.turn_rad[0], change.turn_rad[1], change.turn_rad[2]) * degrees;
}

Figures figures_of(const calib::ChangedChannel& each) {
  return {{"ommatidium", each.channel},
          {"change", each.change.value},
          {"sigma", each.change.sigma},
          {"chance", each.change.chance}};
}

/// "17 by -5.1 %, 20 by +3.0 %"
std::string list_of(const std::vector<calib::ChangedChannel>& channels) {
  constexpr std::size_t most = 8;
  std::string text;
  for (std::size_t k = 0; k < std::min(channels.size(), most); ++k) {
    text += fmt::format("{}{} by {:+.1f} %", k == 0 ? "" : ", ", channels[k].channel, 100.0 * channels[k].change.value);
  }
  return channels.size() > most ? text + fmt::format(" and {} more", channels.size() - most) : text;
}

}  // namespace

Figures check_report(const std::string& file, const EyeCheck& check, const calib::EyeChange& change) {
  Value::List channels;
  for (const calib::ChangedChannel& each : change.channels) channels.emplace_back(figures_of(each));
  Value::List darks;
  for (const calib::ChangedChannel& each : change.dark_channels) darks.emplace_back(figures_of(each));
  Figures f{{"file", file},
            {"session", check.session()},
            {"estimate", check.estimate()},
            {"changed", change.changed()},
            {"gain", Figures{{"changed", change.gain_changed},
                             {"value", change.gain.value},
                             {"sigma", change.gain.sigma},
                             {"chance", change.gain.chance}}},
            {"turn", Figures{{"changed", change.turned},
                             {"deg", turn_deg(change)},
                             {"about_x_deg", change.turn_rad[0] * degrees},
                             {"about_y_deg", change.turn_rad[1] * degrees},
                             {"about_z_deg", change.turn_rad[2] * degrees},
                             {"sigma_x_deg", change.turn_sigma[0] * degrees},
                             {"sigma_y_deg", change.turn_sigma[1] * degrees},
                             {"sigma_z_deg", change.turn_sigma[2] * degrees},
                             {"chance", change.turn_chance}}},
            {"ommatidia", std::move(channels)},
            {"dark", Figures{{"changed", change.dark_changed},
                             {"value", change.dark.value},
                             {"sigma", change.dark.sigma},
                             {"chance", change.dark.chance}}},
            {"dark_ommatidia", std::move(darks)},
            {"rest", Figures{{"changed", change.rest_changed},
                             {"chi2", change.rest_chi2},
                             {"share", change.rest_share},
                             {"chance", change.rest_chance}}}};
  f.tell("{file}: four frames against session {session}\n");
  f.say(fmt::format("gain: {:+.2f} % (one sigma: {:.2f} %): {}\n", 100.0 * change.gain.value, 100.0 * change.gain.sigma,
                    change.gain_changed ? "changed" : "as it was"));
  f.say(fmt::format("pose: {:.3f} deg (about x {:+.3f}, y {:+.3f}, z {:+.3f}): {}\n", turn_deg(change),
                    change.turn_rad[0] * degrees, change.turn_rad[1] * degrees, change.turn_rad[2] * degrees,
                    change.turned ? "changed" : "as it was"));
  f.say(change.channels.empty() ? "ommatidia: none stands out\n"
                                : fmt::format("ommatidia: {}\n", list_of(change.channels)));
  f.say(fmt::format("dark levels: {:+.2f} % of white: {}{}\n", 100.0 * change.dark.value,
                    change.dark_changed ? "changed" : "as they were",
                    change.dark_channels.empty() ? "" : "; ommatidia " + list_of(change.dark_channels)));
  f.say(fmt::format("the rest: {:.2f} % of the light beyond noise (chi^2 {:.2f} a sample): {}\n",
                    100.0 * change.rest_share, change.rest_chi2, change.rest_changed ? "changed" : "as it was"));
  return f;
}

hal::Result<void> check_verdict(const std::string& file, const calib::EyeChange& change) {
  if (!change.changed()) return {};
  std::string what;
  const auto add = [&](const std::string& part) { what += (what.empty() ? "" : ", ") + part; };
  if (change.gain_changed) {
    add(fmt::format("{:+.2f} % of light (brighten or dim the display back, else calibrate again)",
                    100.0 * change.gain.value));
  }
  if (change.turned) {
    add(fmt::format("{:.2f} deg of turn, or a display that was moved (put it back, else calibrate again)",
                    turn_deg(change)));
  }
  if (!change.channels.empty()) {
    add(fmt::format("ommatidia {} (clean them, else calibrate again)", list_of(change.channels)));
  }
  if (change.dark_changed || !change.dark_channels.empty()) {
    add("dark levels (keep other light away and the eye as warm as it was, else calibrate again)");
  }
  if (change.rest_changed) add("something that is none of gain, pose or single ommatidia (calibrate again)");
  return hal::fail(hal::ErrorCode::mismatch, file, "is of an eye that has changed since: " + what);
}

}  // namespace compueye::firmware
