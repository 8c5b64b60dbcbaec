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
///
/// A change is told when a second look sees it too: a hand before the eye during one picture is none, nor is one look
/// in a thousand that noise alone makes.
class CheckDiary {
 public:
  CheckDiary(EyeCheck check, Around around) : check_(std::move(check)), around_(around) {}

  /// What there is to tell of this one, empty where that is nothing new: what changed in this look and the one before
  /// and was not told since the eye last was as it had been, that it is so again, or why a check could not look where
  /// the one before could.
  [[nodiscard]] std::string enter(const CheckLook& look);

  /// Something changed in the last look that no other has seen: do not wait for the next check.
  [[nodiscard]] bool wants_another() const noexcept { return wants_another_; }
  /// What is known of the eye: what was told and is so still, what the last look alone saw, "as in its session", or
  /// "none" before any look.
  [[nodiscard]] std::string verdict() const;

  [[nodiscard]] const EyeCheck& check() const noexcept { return check_; }
  [[nodiscard]] std::uint64_t looks() const noexcept { return looks_; }
  [[nodiscard]] std::uint64_t could_not_look() const noexcept { return could_not_look_; }  ///< of them
  [[nodiscard]] std::uint64_t changes() const noexcept { return changes_; }                ///< that were told
  [[nodiscard]] std::uint64_t unconfirmed() const noexcept { return unconfirmed_; }  ///< looks whose change was gone
  /// Of the last check that could look, and of the last one that could not.
  [[nodiscard]] const std::optional<calib::EyeChange>& last() const noexcept { return last_; }
  [[nodiscard]] const std::optional<hal::Error>& last_failure() const noexcept { return last_failure_; }

 private:
  [[nodiscard]] std::string failed(hal::Error error);

  EyeCheck check_;
  Around around_;
  std::uint64_t looks_ = 0, could_not_look_ = 0, changes_ = 0, unconfirmed_ = 0;
  bool wants_another_ = false;
  std::optional<calib::EyeChange> last_;
  std::optional<hal::Error> last_failure_;
  bool failing_ = false;
  // What of the eye, and which ommatidium.
  using Parts = std::set<std::pair<int, int>>;
  Parts told_, doubted_;  // the second: of the last look, by it alone
  std::string told_text_;
};

}  // namespace compueye::firmware
