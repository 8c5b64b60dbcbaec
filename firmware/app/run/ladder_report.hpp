#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "firmware/app/report/json_report.hpp"

namespace compueye::firmware {

/// What a run with stored points says about its deadline.
struct LadderReport {
  struct Rung {
    std::string point;  ///< "admm dct, 30 iterations"
    double nmse = 0.0;  ///< mean on the evaluation scenes
    double p999_ms = 0.0;
    std::uint64_t frames = 0;  ///< delivered
  };
  double deadline_ms = 0.0;
  double age_ms = 0.0;
  bool fits = false;
  std::uint64_t memory_bytes = 0;
  std::vector<Rung> rungs;
  std::uint64_t steps_down = 0;
  std::uint64_t steps_up = 0;
  std::string sentence;
};

/// "stepped down 2 times and up once; frames: ..."
[[nodiscard]] std::string steps_text(const LadderReport& report);
[[nodiscard]] Json ladder_json(const LadderReport& report, std::uint64_t misses);

}  // namespace compueye::firmware
