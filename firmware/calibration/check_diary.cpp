#include "firmware/calibration/check_diary.hpp"

#include <algorithm>

#include "firmware/calibration/change_text.hpp"

namespace compueye::firmware {
namespace {

enum Part { gain, turn, dark, rest, ommatidium, dark_ommatidium };

std::set<std::pair<int, int>> parts_of(const calib::EyeChange& change) {
  constexpr int all = -1;
  std::set<std::pair<int, int>> parts;
  if (change.gain_changed) parts.insert({gain, all});
  if (change.turned) parts.insert({turn, all});
  if (change.dark_changed) parts.insert({dark, all});
  if (change.rest_changed) parts.insert({rest, all});
  for (const calib::ChangedChannel& each : change.channels) parts.insert({ommatidium, each.channel});
  for (const calib::ChangedChannel& each : change.dark_channels) parts.insert({dark_ommatidium, each.channel});
  return parts;
}

}  // namespace

std::string CheckDiary::failed(hal::Error error) {
  ++could_not_look_;
  last_failure_ = std::move(error);
  if (failing_) return {};
  failing_ = true;
  return "check " + std::to_string(looks_) + " of the eye could not look: " + last_failure_->text();
}

std::string CheckDiary::enter(const CheckLook& look) {
  ++looks_;
  if (!look.seen) return failed(look.seen.error());
  auto judged = check_.judge(*look.seen, around_);
  if (!judged) return failed(std::move(judged.error()));
  failing_ = false;
  last_ = std::move(*judged);
  const std::string number = "check " + std::to_string(looks_);
  const auto parts = parts_of(*last_);
  if (parts.empty()) {
    if (told_.empty()) return {};
    told_.clear();
    return number + ": the eye sees again as in its session";
  }
  if (std::ranges::includes(told_, parts)) return {};
  told_.insert(parts.begin(), parts.end());
  ++changes_;
  return number + ": the eye has changed since its session: " + change_text(*last_);
}

}  // namespace compueye::firmware
