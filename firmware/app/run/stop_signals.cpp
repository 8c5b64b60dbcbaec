#include "firmware/app/run/stop_signals.hpp"

#include <array>
#include <csignal>
#include <cstddef>

namespace compueye::firmware {
namespace {

constexpr std::array<int, 3> signals{SIGINT, SIGTERM, SIGHUP};

// A handler can reach statics only, and may touch nothing but a lock-free atomic.
std::atomic<bool> stop_requested{false};
static_assert(std::atomic<bool>::is_always_lock_free);
std::array<struct sigaction, signals.size()> before{};

void request_stop(int /*signal*/) {
  stop_requested.store(true, std::memory_order_relaxed);
}

}  // namespace

StopSignals::StopSignals() {
  stop_requested.store(false, std::memory_order_relaxed);
  struct sigaction action {};
  action.sa_handler = request_stop;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  for (std::size_t i = 0; i < signals.size(); ++i) {
    sigaction(signals[i], nullptr, &before[i]);
    // nohup and background jobs of a shell ignore them on purpose.
    if (before[i].sa_handler != SIG_IGN) sigaction(signals[i], &action, nullptr);
  }
}

StopSignals::~StopSignals() {
  // Whoever asked once may ask again while the program is on its way out, and must not spoil its exit code.
  if (stop_requested.load(std::memory_order_relaxed)) return;
  for (std::size_t i = 0; i < signals.size(); ++i) sigaction(signals[i], &before[i], nullptr);
}

const std::atomic<bool>& StopSignals::requested() const noexcept {
  return stop_requested;
}

}  // namespace compueye::firmware
