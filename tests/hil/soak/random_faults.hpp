#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "drivers/protocol/device_emulator.hpp"

namespace compueye::hil {

/// What goes wrong at once: up to three faults of the way (damage, losses, overruns, requests that are not answered)
/// and at most one of the device (gone, rebooted, silent, halted, babbling), all within a few frames.
struct Incident {
  std::vector<protocol::EmulatorFault> faults;
  std::int64_t reader_sleeps_ns = 0;  ///< the host is late; only when the device stays as it is
  std::int64_t over_ns = 0;           ///< by then all of it has begun; the next one is not drawn before
};

/// Draws incidents, each from every kind of fault that can be recovered from.
class RandomFaults {
 public:
  RandomFaults(std::uint64_t seed, std::string serial) : random_(seed), serial_(std::move(serial)) {}

  /// The next one, from `now_ns` on.
  [[nodiscard]] Incident next(std::int64_t now_ns);
  /// Whatever may meet: up to four faults of the way, answers that are lost, up to three of the device, in any order,
  /// while it recovers or not, a clock that is set, and a reader who may be away for longer than HID's numbers last.
  [[nodiscard]] Incident meeting(std::int64_t now_ns);
  /// Frames until the next one.
  [[nodiscard]] std::uint64_t calm_frames() { return 20 + below(150); }

 private:
  [[nodiscard]] std::uint64_t below(std::uint64_t limit) { return random_() % limit; }
  [[nodiscard]] std::int64_t up_to_ns(std::int64_t limit_ns) {
    return 1 + static_cast<std::int64_t>(below(static_cast<std::uint64_t>(limit_ns)));
  }
  [[nodiscard]] protocol::EmulatorFault of_the_way(std::int64_t now_ns);
  void add_of_the_device(std::vector<protocol::EmulatorFault>& faults, std::int64_t at_ns);

  std::mt19937_64 random_;
  std::string serial_;
};

}  // namespace compueye::hil
