#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "firmware/realtime/realtime_settings.hpp"

namespace compueye::firmware {

/// Asks the operating system for what RealtimeSettings want. Whatever it refuses is a note, with what to do about it,
/// and the run goes on without.
class Realtime {
 public:
  explicit Realtime(RealtimeSettings settings) : settings_(std::move(settings)) {}

  /// Before any thread of the solver is made, by the thread that makes them: they inherit its processors.
  void begin_process();
  /// By the acquire thread, before its first frame: priority, processors, and a stack that is there already.
  void begin_acquire();
  /// By every other thread of the pipeline: a stack that is there already.
  void begin_other();

  /// Refusals so far, each once.
  [[nodiscard]] std::vector<std::string> notes() const;
  /// What was granted, for reports: "SCHED_FIFO 40, memory locked, acquire on 3"; "nothing was asked for".
  [[nodiscard]] std::string granted() const;

 private:
  void note(const std::string& sentence);
  void grant(const std::string& what);
  void choose_cpus(const std::vector<int>& cpus, const char* key);

  const RealtimeSettings settings_;
  mutable std::mutex mutex_;
  std::vector<std::string> notes_, granted_;
};

/// Touches the stack below the caller, so that its first use costs no page fault later.
void prefault_stack() noexcept;

}  // namespace compueye::firmware
