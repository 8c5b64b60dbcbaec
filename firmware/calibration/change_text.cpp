#include "firmware/calibration/change_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace compueye::firmware {

double turn_deg(const calib::EyeChange& change) {
  return std::hypot(change.turn_rad[0], change.turn_rad[1], change.turn_rad[2]) * 180.0 / std::numbers::pi;
}

std::string list_of(const std::vector<calib::ChangedChannel>& channels) {
  constexpr std::size_t most = 8;
  std::string text;
  for (std::size_t k = 0; k < std::min(channels.size(), most); ++k) {
    text += fmt::format("{}{} by {:+.1f} %", k == 0 ? "" : ", ", channels[k].channel, 100.0 * channels[k].change.value);
  }
  return channels.size() > most ? text + fmt::format(" and {} more", channels.size() - most) : text;
}

std::string change_text(const calib::EyeChange& change) {
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
  const std::string noise = fmt::format(
      "noise {:.1f} times what it was (look for a loose wire, a restless lamp or supply)", change.noise_ratio);
  if (change.rest_changed) {
    const bool or_noise = change.noise_ratio > calib::LeastChange::noise_ratio;
    add("something that is none of gain, pose or single ommatidia (calibrate again)" +
        (or_noise ? ", or " + noise : ""));
  }
  if (change.noisier) add(noise);
  return what;
}

}  // namespace compueye::firmware
