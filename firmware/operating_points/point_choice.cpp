#include "firmware/operating_points/point_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "firmware/operating_points/deadline_choice.hpp"
#include "firmware/text/number_text.hpp"

namespace compueye::firmware {
namespace {

std::size_t nearest_level(const Sweep& sweep, double sigma) {
  const auto distance = [&](const NoiseLevel& level) { return std::abs(std::log(level.sigma / sigma)); };
  const auto nearest =
      std::min_element(sweep.levels.begin(), sweep.levels.end(),
                       [&](const NoiseLevel& a, const NoiseLevel& b) { return distance(a) < distance(b); });
  return static_cast<std::size_t>(nearest - sweep.levels.begin());
}

std::uint64_t memory_of(const Sweep& sweep, const std::vector<std::size_t>& ladder) {
  std::vector<std::pair<Curve, std::uint64_t>> curves;
  for (const std::size_t i : ladder) {
    const MeasuredPoint& point = sweep.points[i];
    const std::uint64_t bytes = point.table_bytes + point.workspace_bytes;
    const auto same =
        std::find_if(curves.begin(), curves.end(), [&](const auto& one) { return one.first == point.curve; });
    if (same == curves.end()) {
      curves.emplace_back(point.curve, bytes);
    } else {
      same->second = std::max(same->second, bytes);
    }
  }
  std::uint64_t total = 0;
  for (const auto& [curve, bytes] : curves) total += bytes;
  return total;
}

/// A frame does not say how many threads it took or how it started.
bool frames_look_alike(const MeasuredPoint& a, const MeasuredPoint& b) {
  return a.curve.solver == b.curve.solver && a.curve.basis == b.curve.basis && a.curve.precision == b.curve.precision &&
         a.op == b.op && a.iterations == b.iterations;
}

double nmse_of(const MeasuredPoint& point, std::size_t level) {
  return point.levels[level].quality.mean.nmse;
}

/// Efficient points that are worth a picture, by cost: better than the same eye with narrow ommatidia shows unsolved.
std::vector<std::size_t> worth_a_picture(const Sweep& sweep, std::size_t level) {
  std::vector<std::size_t> front = efficient_points(sweep, level, &MeasuredPoint::p999_ms);
  if (front.empty()) front.push_back(0);  // nothing but still scenes was measured
  if (level >= sweep.conventional.size()) return front;
  const double worst = worth_share * sweep.conventional[level].mean.nmse;
  std::erase_if(front, [&](std::size_t i) { return !(nmse_of(sweep.points[i], level) < worst); });
  return front;
}

}  // namespace

PointChoice choose_points(const Sweep& sweep, double sigma, double deadline_ms, double period_ms) {
  PointChoice choice;
  choice.deadline_ms = deadline_ms;
  choice.level = nearest_level(sweep, sigma);
  const auto cost = [&](std::size_t i) { return sweep.points[i].p999_ms; };
  std::vector<std::size_t> front = worth_a_picture(sweep, choice.level);
  if (front.empty()) return choice;
  const std::size_t fastest = front.front();
  std::erase_if(front, [&](std::size_t i) { return sweep.points[i].median_ms > period_ms; });
  choice.keeps_up = !front.empty();
  if (front.empty()) front.push_back(fastest);
  const double least_age_ms = predicted_age_ms(cost(front.front()), period_ms);
  std::size_t chosen = 0;
  for (std::size_t f = 0; f < front.size(); ++f) {
    const double age_ms = predicted_age_ms(cost(front[f]), period_ms);
    const bool fits = age_ms <= deadline_share * deadline_ms;
    choice.fits = choice.fits || (fits && choice.keeps_up);
    if (fits || (!choice.fits && age_ms <= nearly_as_fast * least_age_ms)) chosen = f;
  }
  choice.ladder.push_back(front[chosen]);
  choice.age_ms = predicted_age_ms(cost(front[chosen]), period_ms);
  const std::uint64_t alone = memory_of(sweep, choice.ladder);
  for (std::size_t f = chosen; f-- > 0 && choice.ladder.size() < most_rungs;) {
    if (cost(front[f]) * rung_speed_up > cost(choice.ladder.back())) continue;
    const bool told_apart = std::none_of(choice.ladder.begin(), choice.ladder.end(), [&](std::size_t other) {
      return frames_look_alike(sweep.points[front[f]], sweep.points[other]);
    });
    if (!told_apart) continue;
    std::vector<std::size_t> longer = choice.ladder;
    longer.push_back(front[f]);
    if (memory_of(sweep, longer) <= alone + most_ladder_bytes) choice.ladder = std::move(longer);
  }
  choice.memory_bytes = memory_of(sweep, choice.ladder);
  return choice;
}

std::string point_text(const MeasuredPoint& point) {
  return fmt::format("{}, {} iteration{}", title(point.curve), point.iterations, point.iterations == 1 ? "" : "s");
}

std::string sentence(const PointChoice& choice, const Sweep& sweep) {
  if (choice.ladder.empty()) {
    return fmt::format("none of the {} stored points is clearly better than the conventional eye", sweep.points.size());
  }
  const auto ms = [](double value) { return significant(value, 3) + " ms"; };
  const MeasuredPoint& chosen = sweep.points[choice.ladder.front()];
  const std::string figures = fmt::format(
      "{}: NMSE {} on the evaluation scenes at sigma {}, 99.9 % of frames solved within {}, pictures then {} old",
      point_text(chosen), significant(nmse_of(chosen, choice.level), 3),
      significant(sweep.levels[choice.level].sigma, 3), ms(chosen.p999_ms), ms(choice.age_ms));
  if (!choice.fits) {
    return fmt::format(
        "the deadline of {} cannot be kept{} by any of the {} stored points that is better than the conventional "
        "eye{}; "
        "running with the most accurate of the fastest, {}",
        ms(choice.deadline_ms), choice.keeps_up ? "" : ", nor the rate of the frames,", sweep.points.size(),
        choice.level < sweep.conventional.size()
            ? fmt::format(" (NMSE {})", significant(sweep.conventional[choice.level].mean.nmse, 3))
            : "",
        figures);
  }
  std::string text = fmt::format(
      "the deadline of {} is met by {}; no more accurate one of the {} stored points leaves a fifth of it as head-room "
      "and keeps up with the frames",
      ms(choice.deadline_ms), figures, sweep.points.size());
  if (choice.ladder.size() == 1) return text + "; there is no faster one to step down to";
  text += "; steps down to";
  for (std::size_t r = 1; r < choice.ladder.size(); ++r) {
    text += fmt::format("{} {}", r > 1 ? "," : "", point_text(sweep.points[choice.ladder[r]]));
  }
  return text + fmt::format("; {} of memory for all of them", bytes(choice.memory_bytes));
}

}  // namespace compueye::firmware
