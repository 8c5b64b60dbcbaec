#pragma once

#include <atomic>

namespace compueye::firmware {

/// While it lives, SIGINT (Ctrl-C), SIGTERM and SIGHUP ask for an orderly end instead of killing the process. Repeating
/// them changes nothing: the end is at most a frame away, and being impatient must not leave half a file behind. One at
/// a time.
class StopSignals {
 public:
  StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;
  /// Gives the signals back to what handled them before, unless a stop was asked for: the program is then ending.
  ~StopSignals();

  [[nodiscard]] const std::atomic<bool>& requested() const noexcept;
};

}  // namespace compueye::firmware
