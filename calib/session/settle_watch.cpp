#include "calib/session/settle_watch.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace compueye::calib {
namespace {

constexpr std::size_t least_frames = 8;

}  // namespace

void SettleWatch::add(std::int64_t begun_ns, double mean_code) {
  seen_.push_back({begun_ns, mean_code});
}

bool SettleWatch::complete() const noexcept {
  return seen_.size() >= least_frames && seen_.back().begun_ns >= changed_ns_ + longest_ns_;
}

std::optional<std::int64_t> SettleWatch::settled_after_ns() const {
  if (!complete()) return std::nullopt;
  // The last quarter of what was seen, by which light has to be settled.
  const std::size_t last = std::max<std::size_t>(seen_.size() / 4, 2), from = seen_.size() - last;
  double sum = 0.0, squares = 0.0, change = 0.0;
  for (std::size_t k = from; k < seen_.size(); ++k) sum += seen_[k].mean;
  const double settled = sum / static_cast<double>(last);
  for (std::size_t k = from; k < seen_.size(); ++k) squares += std::pow(seen_[k].mean - settled, 2);
  for (const Seen& each : seen_) change = std::max(change, std::fabs(each.mean - settled));
  constexpr double deviations = 5.0, share = 0.01, least_lsb = 0.5;
  const double spread = std::sqrt(squares / static_cast<double>(last - 1));
  const double allowed = std::max({deviations * spread, share * change, least_lsb});
  if (deviations * spread > 0.1 * change && change > 10.0 * least_lsb) return std::nullopt;  // it is still on its way
  std::size_t first = seen_.size();
  while (first > 0 && std::fabs(seen_[first - 1].mean - settled) <= allowed) --first;
  if (first >= from) return std::nullopt;
  return std::max<std::int64_t>(seen_[first].begun_ns - changed_ns_, 0);
}

}  // namespace compueye::calib
