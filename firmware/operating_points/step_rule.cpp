#include "firmware/operating_points/step_rule.hpp"

#include <algorithm>

namespace compueye::firmware {

void StepRule::step_to(std::size_t rung, std::int64_t now_ns) noexcept {
  const bool down = rung > rung_;
  // Taken back before it held: the load is still there.
  if (down && trying_) calm_ns_ = std::min(2 * calm_ns_, settings_.most_calm_ns);
  ++(down ? steps_down_ : steps_up_);
  trying_ = !down;
  rung_ = rung;
  weight_ = 0;
  in_time_ = 0;
  calm_since_ns_ = now_ns;
}

void StepRule::published(std::size_t rung, bool late, std::int64_t now_ns) noexcept {
  if (!begun_) calm_since_ns_ = now_ns;
  begun_ = true;
  if (late) ++misses_;
  if (rung != rung_) return;
  if (late) {
    weight_ += settings_.miss_weight;
    in_time_ = 0;
    calm_since_ns_ = now_ns;
    if (weight_ < settings_.weight_down) return;
    weight_ = settings_.weight_down;  // on the last rung it would grow without end
    if (rung_ + 1 < rungs_) step_to(rung_ + 1, now_ns);
    return;
  }
  weight_ = std::max(0, weight_ - 1);
  in_time_ = std::min(in_time_ + 1, settings_.calm_frames);
  if (in_time_ < settings_.calm_frames || now_ns - calm_since_ns_ < calm_ns_) return;
  if (trying_) {
    trying_ = false;
    calm_ns_ = settings_.calm_ns;
  }
  if (rung_ > 0) step_to(rung_ - 1, now_ns);
}

}  // namespace compueye::firmware
