#include "firmware/calibration/check_diary.hpp"

#include <algorithm>
#include <iterator>

#include "firmware/calibration/change_text.hpp"

namespace compueye::firmware {
namespace {

enum Part { gain, turn, dark, rest, noise, ommatidium, dark_ommatidium };

std::set<std::pair<int, int>> parts_of(const calib::EyeChange& change) {
  constexpr int all = -1;
  std::set<std::pair<int, int>> parts;
  if (change.gain_changed) parts.insert({gain, all});
  if (change.turned) parts.insert({turn, all});
  if (change.dark_changed) parts.insert({dark, all});
  if (change.rest_changed) parts.insert({rest, all});
  if (change.noisier) parts.insert({noise, all});
  for (const calib::ChangedChannel& each : change.channels) parts.insert({ommatidium, each.channel});
  for (const calib::ChangedChannel& each : change.dark_channels) parts.insert({dark_ommatidium, each.channel});
  return parts;
}

/// What of a change is among `parts`.
calib::EyeChange only(calib::EyeChange change, const std::set<std::pair<int, int>>& parts) {
  constexpr int all = -1;
  const auto has = [&](Part part, int channel) { return parts.contains({part, channel}); };
  change.gain_changed = has(gain, all);
  change.turned = has(turn, all);
  change.dark_changed = has(dark, all);
  change.rest_changed = has(rest, all);
  change.noisier = has(noise, all);
  std::erase_if(change.channels, [&](const auto& each) { return !has(ommatidium, each.channel); });
  std::erase_if(change.dark_channels, [&](const auto& each) { return !has(dark_ommatidium, each.channel); });
  return change;
}

}  // namespace

std::string CheckDiary::failed(hal::Error error) {
  ++could_not_look_;
  wants_another_ = false;
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
  const Parts parts = parts_of(*last_);
  Parts news, seen_twice;
  std::ranges::set_difference(parts, told_, std::inserter(news, news.end()));
  std::ranges::set_intersection(news, doubted_, std::inserter(seen_twice, seen_twice.end()));
  unconfirmed_ += !doubted_.empty() && seen_twice.empty();
  // What comes with something that is told has to be seen again, too, but is in no hurry.
  wants_another_ = !news.empty() && seen_twice.empty();
  doubted_.clear();
  std::ranges::set_difference(news, seen_twice, std::inserter(doubted_, doubted_.end()));
  if (!seen_twice.empty()) {
    told_.insert(seen_twice.begin(), seen_twice.end());
    told_text_ = change_text(only(*last_, told_));
    ++changes_;
    return number + ": the eye has changed since its session: " + told_text_;
  }
  if (!parts.empty() || told_.empty()) return {};
  told_.clear();
  return number + ": the eye sees again as in its session";
}

std::string CheckDiary::verdict() const {
  if (!last_) return "none";
  if (!told_.empty()) return told_text_;
  return last_->changed() ? "changed in the last look, which no other has confirmed: " + change_text(*last_)
                          : "as in its session";
}

}  // namespace compueye::firmware
