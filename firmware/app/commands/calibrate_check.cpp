#include "firmware/app/commands/calibrate_check.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "firmware/calibration/change_text.hpp"

namespace compueye::firmware {
namespace {

constexpr double degrees = 180.0 / std::numbers::pi;

Figures figures_of(const calib::ChangedChannel& each) {
  return {{"ommatidium", each.channel},
          {"change", each.change.value},
          {"sigma", each.change.sigma},
          {"chance", each.change.chance}};
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
            {"dark", Figures{{"judged", change.dark_judged},
                             {"changed", change.dark_changed},
                             {"value", change.dark.value},
                             {"sigma", change.dark.sigma},
                             {"chance", change.dark.chance}}},
            {"dark_ommatidia", std::move(darks)},
            {"rest", Figures{{"changed", change.rest_changed},
                             {"chi2", change.rest_chi2},
                             {"share", change.rest_share},
                             {"chance", change.rest_chance}}},
            {"noise", Figures{{"changed", change.noisier}, {"ratio", change.noise_ratio}}}};
  f.tell("{file}: four frames against session {session}\n");
  f.say(fmt::format("gain: {:+.2f} % (one sigma: {:.2f} %): {}\n", 100.0 * change.gain.value, 100.0 * change.gain.sigma,
                    change.gain_changed ? "changed" : "as it was"));
  f.say(fmt::format("pose: {:.3f} deg (about x {:+.3f}, y {:+.3f}, z {:+.3f}): {}\n", turn_deg(change),
                    change.turn_rad[0] * degrees, change.turn_rad[1] * degrees, change.turn_rad[2] * degrees,
                    change.turned ? "changed" : "as it was"));
  f.say(change.channels.empty() ? "ommatidia: none stands out\n"
                                : fmt::format("ommatidia: {}\n", list_of(change.channels)));
  f.say(fmt::format("dark levels: {:+.2f} % of white: {}{}\n", 100.0 * change.dark.value,
                    !change.dark_judged   ? "not judged, there was light beside the lamp's"
                    : change.dark_changed ? "changed"
                                          : "as they were",
                    change.dark_channels.empty() ? "" : "; ommatidia " + list_of(change.dark_channels)));
  f.say(fmt::format("the rest: {:.2f} % of the light beyond noise (chi^2 {:.2f} a sample): {}\n",
                    100.0 * change.rest_share, change.rest_chi2, change.rest_changed ? "changed" : "as it was"));
  if (change.noise_ratio > 1.0) {
    f.say(fmt::format("noise: {:.1f} times the session's{}\n", change.noise_ratio,
                      change.noisier ? ": changed" : ", or a change of every channel"));
  }
  return f;
}

hal::Result<void> check_verdict(const std::string& file, const calib::EyeChange& change) {
  const std::string what = change_text(change);
  if (what.empty()) return {};
  return hal::fail(hal::ErrorCode::stale, file, "is of an eye that has changed since: " + what);
}

}  // namespace compueye::firmware
