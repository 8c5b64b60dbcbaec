#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "firmware/eye/board.hpp"
#include "hal/clock.hpp"
#include "hal/sample_source.hpp"

namespace compueye::firmware {

enum class Health : std::uint8_t {
  good,
  note,  ///< works, and could be better
  bad,   ///< does not work, or not as it must
  none,  ///< there is nothing to look at, or it does not concern this board
};
[[nodiscard]] std::string_view name(Health health) noexcept;

/// What a check found.
struct Finding {
  Health health = Health::none;
  std::string what;       ///< a sentence without its full stop
  std::string todo = {};  ///< what to type or do; empty where nothing is to be done
};

/// What the process may do, as the system says it.
struct Limits {
  std::uint64_t realtime_priority = 0;
  std::uint64_t locked_bytes = 0;  ///< the greatest number: without end
};
[[nodiscard]] Limits own_limits() noexcept;

/// What checks look at. Nothing of it is changed.
struct Examined {
  const Board& board;
  hal::Clock& clock;
  std::string root = {};  ///< before every path of the system, for tests: "" or a folder
  Limits limits = own_limits();
  std::optional<double> deadline_ms = {};
  int frames = 200;  ///< of the link's check, >= 2
  std::function<bool()> go_on = [] { return true; };
  /// The board's eye; board_source() where it is empty.
  std::function<hal::Result<std::unique_ptr<hal::SampleSource>>()> eye = {};
};

/// A question, as a row of doctor_checks(). To add one takes its function, in the file of its kind, and its row.
struct DoctorCheck {
  std::string_view name;
  std::string_view question;
  Finding (*examine)(const Examined&);
};
[[nodiscard]] std::span<const DoctorCheck> doctor_checks() noexcept;

/// The table of docs/doctor.md.
[[nodiscard]] std::string doctor_reference();

// machine_checks.cpp
[[nodiscard]] Finding examine_kernel(const Examined&);
[[nodiscard]] Finding examine_governor(const Examined&);
[[nodiscard]] Finding examine_throttling(const Examined&);
[[nodiscard]] Finding examine_realtime(const Examined&);
[[nodiscard]] Finding examine_locking(const Examined&);
[[nodiscard]] Finding examine_clock_source(const Examined&);
[[nodiscard]] Finding examine_space(const Examined&);
// wire_checks.cpp
[[nodiscard]] Finding examine_device_files(const Examined&);
[[nodiscard]] Finding examine_udev_rule(const Examined&);
[[nodiscard]] Finding examine_bufsiz(const Examined&);
[[nodiscard]] Finding examine_usbfs(const Examined&);
// eye_checks.cpp
[[nodiscard]] Finding examine_eye(const Examined&);
[[nodiscard]] Finding examine_link(const Examined&);
[[nodiscard]] Finding examine_deadline(const Examined&);

}  // namespace compueye::firmware
