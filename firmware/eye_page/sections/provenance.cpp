#include <fmt/format.h>

#include "firmware/eye_page/plots/markup.hpp"
#include "firmware/eye_page/sections/sections.hpp"
#include "firmware/text/date.hpp"
#include "firmware/text/number_text.hpp"

namespace compueye::firmware {
namespace {

std::string sessions_of(const calib::Estimate& estimate) {
  return estimate.sessions.empty() ? "none: from elsewhere" : fmt::format("{}", fmt::join(estimate.sessions, ", "));
}

std::string newest_table(const PageEstimate& newest) {
  const calib::Estimate& e = newest.estimate;
  std::vector<std::vector<std::string>> rows{
      {"estimate", std::to_string(newest.stored.id)},
      {"began from estimate", e.parent ? std::to_string(*e.parent) : "none"},
      {"from sessions", sessions_of(e)},
      {"method", e.method},
      {"made", utc(e.made_unix_s)},
      {"by program", e.program},
      {"distance, mm", fmt::format("{:.6g}", e.distance_mm)},
      {"hash of the captures", fmt::format("{:016x}", newest.stored.raw_hash)},
      {"hash of the rows", fmt::format("{:016x}", newest.rows.response.content_hash())},
      {"entries", grouped(newest.rows.response.stored_entries())}};
  for (const calib::NamedNumber& number : e.shared) rows.push_back({number.name, significant(number.value, 4)});
  return html_table({"of the newest estimate", ""}, rows);
}

}  // namespace

hal::Result<std::string> provenance(const PageData& data) {
  if (!data.newest) return std::string();
  std::vector<std::vector<std::string>> all;
  for (const calib::StoredEstimate& each : data.estimates) {
    all.push_back(
        {std::to_string(each.id), each.method, utc(each.made_unix_s), fmt::format("{:.6g}", each.distance_mm)});
  }
  return newest_table(*data.newest) + html_table({"estimate", "method", "made", "distance, mm"}, all, 1);
}

}  // namespace compueye::firmware
