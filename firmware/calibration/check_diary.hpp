#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "calib/check/eye_change.hpp"
#include "firmware/calibration/around.hpp"
#include "firmware/calibration/checked_source.hpp"
#include "firmware/calibration/eye_check.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// Judges what the checks of a run saw, and knows what of it is news. For one thread at a time.
class CheckDiary {
 public:
  CheckDiary(EyeCheck check, Around around) : check_(std::move(check)), around_(around) {}

  /// What there is to tell of this one, empty where that is nothing new: what changed and was not told since the eye
  /// last was as it had been, that it is so again, or why a check could not look where the one before could.
  [[nodiscard]] std::string enter(const CheckLook& look);

  [[nodiscard]] const EyeCheck& check() const noexcept { return check_; }
  [[nodiscard]] std::uint64_t looks() const noexcept { return looks_; }
  [[nodiscard]] std::uint64_t could_not_look() const noexcept { return could_not_look_; }  ///< of them
  [[nodiscard]] std::uint64_t changes() const noexcept { return changes_; }                ///< that were told
  /// Of the last check that could look, and of the last one that could not.
  [[nodiscard]] const std::optional<calib::EyeChange>& last() const noexcept { return last_; }
  [[nodiscard]] const std::optional<hal::Error>& last_failure() const noexcept { return last_failure_; }

 private:
  [[nodiscard]] std::string failed(hal::Error error);

  EyeCheck check_;
  Around around_;
  std::uint64_t looks_ = 0, could_not_look_ = 0, changes_ = 0;
  std::optional<calib::EyeChange> last_;
  std::optional<hal::Error> last_failure_;
  bool failing_ = false;
  std::set<std::pair<int, int>> told_;  // what of the eye, and which ommatidium
};

}  // namespace compueye::firmware
