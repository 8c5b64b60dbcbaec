#include "firmware/app/run/ladder_report.hpp"

#include <fmt/format.h>

namespace compueye::firmware {
namespace {

std::string times(std::uint64_t count) {
  return count == 1 ? "once" : fmt::format("{} times", count);
}

}  // namespace

std::string steps_text(const LadderReport& report) {
  std::string text =
      fmt::format("stepped down {} and up {}; frames of", times(report.steps_down), times(report.steps_up));
  for (std::size_t r = 0; r < report.rungs.size(); ++r) {
    text += fmt::format("{} {}: {}", r > 0 ? "," : "", report.rungs[r].point, report.rungs[r].frames);
  }
  return text;
}

Json ladder_json(const LadderReport& report, std::uint64_t misses) {
  Json json{{"deadline_ms", report.deadline_ms},
            {"fits", report.fits},
            {"chosen_by", "stored points"},
            {"predicted_age_ms", report.age_ms},
            {"memory_bytes", report.memory_bytes},
            {"points", Json::array()},
            {"steps_down", report.steps_down},
            {"steps_up", report.steps_up},
            {"misses", misses}};
  for (const LadderReport::Rung& rung : report.rungs) {
    json["points"].push_back(
        {{"point", rung.point}, {"nmse", rung.nmse}, {"p999_ms", rung.p999_ms}, {"frames", rung.frames}});
  }
  return json;
}

}  // namespace compueye::firmware
