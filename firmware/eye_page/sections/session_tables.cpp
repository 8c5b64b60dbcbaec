#include <fmt/format.h>

#include "firmware/eye_page/plots/markup.hpp"
#include "firmware/eye_page/sections/sections.hpp"
#include "firmware/text/date.hpp"
#include "firmware/text/number_text.hpp"

namespace compueye::firmware {
namespace {

/// What is long, for who asks.
std::string unfolding(const std::string& title, const std::string& text) {
  std::string lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines += escaped(text.substr(begin, end - begin)) + "\n";
    begin = end + 1;
  }
  return lines.empty() ? lines
                       : "<details><summary>" + escaped(title) + "</summary><pre>" + lines + "</pre></details>\n";
}

}  // namespace

hal::Result<std::string> session_table(const PageData& data) {
  if (data.sessions.empty()) return std::string();
  std::vector<std::vector<std::string>> rows;
  std::string more;
  for (const PageSession& session : data.sessions) {
    const calib::Session& s = session.stored.begun;
    rows.push_back({std::to_string(session.stored.id), s.serial, s.firmware, utc(s.started_unix_s),
                    session.stored.end ? "ended" : "cut off or under way", s.pattern_generator, std::to_string(s.seed),
                    std::to_string(s.bits), fmt::format("{:.6g}", s.distance_mm), grouped(session.captures)});
    more += unfolding(fmt::format("plan of session {}", session.stored.id), s.plan);
    more += unfolding(fmt::format("configuration of session {}", session.stored.id), s.configuration);
  }
  return html_table({"session", "serial", "firmware", "begun", "state", "patterns by", "seed", "bits", "distance, mm",
                     "captures"},
                    rows, 4) +
         more;
}

hal::Result<std::string> capture_table(const PageData& data) {
  std::vector<std::vector<std::string>> rows;
  for (const PageSession& session : data.sessions) {
    for (const StageCounts& stage : session.stages) {
      rows.push_back({std::to_string(session.stored.id), stage.stage, grouped(stage.captures), grouped(stage.frames),
                      grouped(stage.retakes), grouped(stage.saturated)});
    }
  }
  if (rows.empty()) return std::string();
  return html_table({"session", "stage", "captures", "frames", "retakes", "saturated"}, rows, 4);
}

}  // namespace compueye::firmware
