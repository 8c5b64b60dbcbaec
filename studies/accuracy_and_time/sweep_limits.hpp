#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include "hal/clock.hpp"
#include "recon/setup/factor.hpp"

namespace compueye::firmware {

/// Whether a sweep may go on, and how far it is: asked before every frame and every step of a set-up.
class SweepLimits {
 public:
  /// Both must outlive this object. `budget_s` may be infinite.
  SweepLimits(const hal::Clock& clock, const recon::Progress& progress, double budget_s)
      : clock_(clock), progress_(progress), began_ns_(clock.now_ns()), budget_s_(budget_s) {}

  /// A new stage that ends at `share` of the budget at the latest.
  void begin(std::string stage, double total, double share) {
    stage_ = std::move(stage);
    total_ = total;
    done_ = 0.0;
    stage_began_s_ = elapsed_s();
    stage_ends_s_ = share * budget_s_;
  }
  void advance(double work) { done_ += work; }

  [[nodiscard]] bool go_on() {
    if (stopped_) return false;
    // Whichever ends the stage first says how far it is.
    double share = total_ > 0.0 ? done_ / total_ : 0.0;
    const double room_s = stage_ends_s_ - stage_began_s_;
    if (room_s > 0.0 && room_s < std::numeric_limits<double>::infinity()) {
      share = std::max(share, (elapsed_s() - stage_began_s_) / room_s);
    }
    stopped_ = !progress_(stage_, share, 1.0);
    return !stopped_ && !out_of_time();
  }
  [[nodiscard]] bool stopped() const noexcept { return stopped_; }  ///< by the user
  [[nodiscard]] bool out_of_time() const noexcept { return elapsed_s() >= stage_ends_s_; }
  [[nodiscard]] double left_s() const noexcept { return stage_ends_s_ - elapsed_s(); }

 private:
  [[nodiscard]] double elapsed_s() const noexcept { return static_cast<double>(clock_.now_ns() - began_ns_) * 1e-9; }

  const hal::Clock& clock_;
  const recon::Progress& progress_;
  std::int64_t began_ns_;
  double budget_s_;
  std::string stage_;
  double total_ = 0.0;
  double done_ = 0.0;
  double stage_began_s_ = 0.0;
  double stage_ends_s_ = std::numeric_limits<double>::infinity();
  bool stopped_ = false;
};

}  // namespace compueye::firmware
