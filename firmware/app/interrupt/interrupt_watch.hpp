#pragma once

#include <signal.h>  // NOLINT(modernize-deprecated-headers): sigset_t is POSIX, not C

#include <atomic>
#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <thread>
#include <vector>

#include "hal/result.hpp"

namespace compueye::firmware {

/// While it lives, Ctrl-C (SIGINT), SIGTERM and SIGHUP stop a command that computes once and writes at the end, with a
/// sentence and nothing half-written. Whoever asks requested() often ends in order; whatever takes longer than the
/// grace time to notice (one very long frame, reading a huge file) is ended from here: partial files are removed, the
/// sentence printed and the process left. One at a time, made while the process has a single thread.
class InterruptWatch {
 public:
  InterruptWatch();
  InterruptWatch(const InterruptWatch&) = delete;
  InterruptWatch& operator=(const InterruptWatch&) = delete;
  ~InterruptWatch();

  [[nodiscard]] bool requested() const noexcept { return requested_.load(std::memory_order_relaxed); }
  /// The error interrupted once a stop was requested.
  [[nodiscard]] hal::Result<void> check() const;

  /// A file that is being written through AtomicFile: its partial file goes when the process is left from here.
  void guard_output(const std::filesystem::path& target);
  /// A whole file that makes no sense without the rest.
  void guard_part(const std::filesystem::path& file);

  /// The work is done and about to be published: from now on nothing stops it. Error interrupted when a stop came
  /// before.
  [[nodiscard]] hal::Result<void> finish();

 private:
  void watch();
  void end_watching();
  [[noreturn]] void leave();

  sigset_t signals_{};
  sigset_t before_{};
  std::atomic<bool> requested_{false};
  std::mutex mutex_;
  std::condition_variable ended_changed_;
  bool ended_ = false;
  std::vector<std::filesystem::path> outputs_;
  std::vector<std::filesystem::path> parts_;
  std::thread thread_;
};

}  // namespace compueye::firmware
