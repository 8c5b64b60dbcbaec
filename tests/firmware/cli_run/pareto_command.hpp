#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/firmware/cli_run/copied_board.hpp"

namespace compueye::test {

/// `compueye pareto --board <board> ...`
inline std::vector<std::string> pareto_arguments(const CopiedBoard& board, std::vector<std::string> more) {
  more.insert(more.begin(), {"pareto", "--board", board.path().string()});
  return more;
}

/// The same with --json, which must work.
inline nlohmann::json pareto_json(const CopiedBoard& board, std::vector<std::string> more) {
  more.emplace_back("--json");
  const Ended ended = compueye(pareto_arguments(board, std::move(more)));
  REQUIRE_MESSAGE(ended.exit_code == 0, ended.err);
  auto json = nlohmann::json::parse(ended.out, nullptr, false);
  REQUIRE_FALSE(json.is_discarded());
  return json;
}

/// What is stored says something else from now on.
template <class Change>
void change_points(const CopiedBoard& board, Change change) {
  const std::filesystem::path path = board.cache() / "accuracy-and-time.json";
  auto json = nlohmann::ordered_json::parse(bytes_of(path), nullptr, false);
  REQUIRE(json.contains("points"));
  change(json);
  std::ofstream(path) << json;
}

/// Says of the stored points what share of a processor their frames had: a test's own may be any.
inline void set_processor_share(const CopiedBoard& board, double share) {
  change_points(board, [share](auto& json) { json["processor_share"] = share; });
}

/// The short form that the tests measure, without an end by time.
inline std::vector<std::string> short_sweep(std::vector<std::string> more = {}) {
  more.insert(more.begin(), {"--quick", "--budget", "0", "--solvers", "admm,tikhonov", "--bases", "identity,dct"});
  return more;
}

/// Mean NMSE of a point in the JSON.
inline double nmse_of(const nlohmann::json& point, std::size_t level) {
  return point["levels"][level]["quality"]["mean"]["nmse"].get<double>();
}

inline bool has_note(const nlohmann::json& json, const std::string& part) {
  for (const nlohmann::json& note : json["notes"]) {
    if (contains(note.get<std::string>(), part)) return true;
  }
  return false;
}

}  // namespace compueye::test
