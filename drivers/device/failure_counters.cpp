#include "drivers/device/failure_counters.hpp"

namespace compueye::device {

std::string_view name(Failure failure) noexcept {
  constexpr std::array<std::string_view, failure_count> names{
      "unplugged",       "absent",        "open_failed",   "other_serial",     "rebooted",         "request_timeout",
      "request_refused", "bad_reply",     "other_version", "other_descriptor", "wrong_echo",       "silence",
      "stream_failed",   "babble",        "crc_error",     "garbage",          "resync",           "cut_report",
      "missing_packet",  "repeated_part", "late_part",     "other_config",     "incomplete_frame", "bad_code",
      "doubtful_time",   "restart",       "bus_reset",     "gave_up"};
  return names[static_cast<std::size_t>(failure)];
}

std::string FailureCounters::text() const {
  std::string text;
  for (std::size_t k = 0; k < failure_count; ++k) {
    if (counts[k] == 0) continue;
    if (!text.empty()) text += ", ";
    text += std::string(name(static_cast<Failure>(k))) + ' ' + std::to_string(counts[k]);
  }
  return text.empty() ? "none" : text;
}

}  // namespace compueye::device
