#pragma once

#include <vector>

namespace compueye::firmware {

/// What a board asks of the operating system for its frames to come in time.
struct RealtimeSettings {
  int priority = 0;               ///< of the acquire thread, SCHED_FIFO 1..99; 0: as any other
  bool lock_memory = false;       ///< no page of the program leaves memory
  std::vector<int> acquire_cpus;  ///< where the acquire thread runs; empty: anywhere
  std::vector<int> solve_cpus;    ///< where every other thread runs; empty: anywhere
};

}  // namespace compueye::firmware
