#pragma once

#include <cstddef>
#include <cstdint>

namespace compueye::firmware {

struct StepSettings {
  /// A miss weighs as much as so many frames in time take back; a step down comes at `weight_down`. With 4 and 12:
  /// after three misses in a row, or where one frame in five is late for long.
  int miss_weight = 4;
  int weight_down = 12;
  std::int64_t calm_ns = 2'000'000'000;        ///< without a miss before a step up is tried ...
  int calm_frames = 20;                        ///< ... and so many frames in time
  std::int64_t most_calm_ns = 64'000'000'000;  ///< what calm grows to when steps up keep failing
};

/// When to go to a faster point and when back: pure, its time comes in. Rung 0 is the point that was chosen, each
/// further one is faster. A step up that has to be taken back doubles the calm that the next one waits for, and one
/// that holds as long as that calm resets it, so that a load that stays makes fewer and fewer attempts instead of
/// flapping.
class StepRule {
 public:
  explicit StepRule(std::size_t rungs, const StepSettings& settings = {}) noexcept
      : settings_(settings), rungs_(rungs), calm_ns_(settings.calm_ns) {}

  /// A frame that was solved on `rung` has been published at `now_ns`. One that was solved before the last step says
  /// nothing about the rung it was for.
  void published(std::size_t rung, bool late, std::int64_t now_ns) noexcept;

  [[nodiscard]] std::size_t rung() const noexcept { return rung_; }
  [[nodiscard]] std::uint64_t steps_down() const noexcept { return steps_down_; }
  [[nodiscard]] std::uint64_t steps_up() const noexcept { return steps_up_; }
  [[nodiscard]] std::uint64_t misses() const noexcept { return misses_; }

 private:
  void step_to(std::size_t rung, std::int64_t now_ns) noexcept;

  StepSettings settings_;
  std::size_t rungs_;
  std::size_t rung_ = 0;
  int weight_ = 0;   // of recent misses on this rung
  int in_time_ = 0;  // frames since the last miss or step
  std::int64_t calm_since_ns_ = 0;
  std::int64_t calm_ns_;  // that a step up waits for
  bool trying_ = false;   // the last step was up and has not held long enough yet
  bool begun_ = false;
  std::uint64_t steps_down_ = 0;
  std::uint64_t steps_up_ = 0;
  std::uint64_t misses_ = 0;
};

}  // namespace compueye::firmware
