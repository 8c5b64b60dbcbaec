#include "firmware/supervisor/supervisor.hpp"

#include <algorithm>
#include <utility>

namespace compueye::firmware {
namespace {

constexpr std::int64_t second_ns = 1'000'000'000;
/// After a line about the run no other follows that is not graver than all of this time: an eye on a loose plug must
/// not fill the log.
constexpr std::int64_t quiet_ns = 5 * second_ns;
constexpr int restart_priority = 2;

int priority_of(const Health& health) noexcept {
  if (!health.alive()) return restart_priority;
  return picture_states[static_cast<std::size_t>(health.picture)].priority;
}

bool is_old(PictureState state) noexcept {
  return state == PictureState::held || state == PictureState::blank;
}

}  // namespace

Supervisor::Supervisor(const HealthLimits& limits, ServiceManager& manager, Say say, bool all)
    : limits_(limits), manager_(manager), say_(std::move(say)), all_(all) {}

void Supervisor::count(std::int64_t now_ns, const Health& health) noexcept {
  if (looked_ns_)
    spent_ns_[static_cast<std::size_t>(health_.picture)] += std::max<std::int64_t>(now_ns - *looked_ns_, 0);
  looked_ns_ = now_ns;
  if (health.picture == PictureState::starting) return;
  if (is_old(health.picture) && !is_old(health_.picture)) ++interruptions_;
  longest_gap_ns_ = std::max(longest_gap_ns_, health.picture_ns);
}

void Supervisor::look(std::int64_t now_ns, const RunCounters& counters, std::string_view line) {
  if (stopped_) return;
  const Health health = assess(limits_, now_ns, counters);
  count(now_ns, health);
  health_ = health;
  tell_people(now_ns);
  tell_manager(now_ns, line);
}

void Supervisor::tell_people(std::int64_t now_ns) {
  if (health_.like(said_)) return;
  if (health_.alive() && !all_) return;
  const int priority = priority_of(health_);
  const bool quiet = said_ns_ && now_ns - *said_ns_ < quiet_ns;
  if (quiet && priority >= gravest_) return;
  if (!quiet) said_ns_ = now_ns;
  gravest_ = quiet ? std::min(gravest_, priority) : priority;
  said_ = health_;
  say_(priority, health_.sentence());
}

void Supervisor::tell_manager(std::int64_t now_ns, std::string_view line) {
  const bool due = !told_ns_ || now_ns - *told_ns_ >= second_ns;
  if (!ready_ && health_.picture != PictureState::starting) {
    ready_ = true;
    manager_.ready();
  }
  if (due) {
    told_ns_ = now_ns;
    const std::string text = health_.sentence() + (line.empty() ? "" : "; ") + std::string(line);
    if (ready_) manager_.status(text);
    if (!ready_ && health_.alive()) manager_.starting(10 * second_ns, text);
  }
  if (!health_.alive()) {
    if (!restart_asked_) manager_.restart_me();
    restart_asked_ = true;
    return;
  }
  restart_asked_ = false;
  const std::int64_t every_ns = manager_.watchdog_ns() / 4;
  if (every_ns <= 0 || (fed_ns_ && now_ns - *fed_ns_ < every_ns)) return;
  fed_ns_ = now_ns;
  manager_.alive();
}

void Supervisor::stop() noexcept {
  if (!stopped_) manager_.stopping();
  stopped_ = true;
}

}  // namespace compueye::firmware
