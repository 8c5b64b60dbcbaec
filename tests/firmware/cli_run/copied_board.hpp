#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/firmware/cli_run/program.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/source_folder.hpp"

namespace compueye::test {

/// A board of the project in a folder of its own, so that its cache begins empty and its file can be changed.
class CopiedBoard {
 public:
  explicit CopiedBoard(const std::string& name = "sim-8x8") : path_(folder_ / name) {
    std::filesystem::create_directory(path_);
    std::filesystem::copy_file(std::filesystem::path(source_path("boards")) / name / "board.toml",
                               path_ / "board.toml");
  }

  /// Replaces the first `before` in board.toml.
  void change(const std::string& before, const std::string& after) const {
    std::string text = bytes_of(path_ / "board.toml");
    const std::size_t at = text.find(before);
    REQUIRE(at != std::string::npos);
    text.replace(at, before.size(), after);
    std::ofstream(path_ / "board.toml", std::ios::binary) << text;
  }

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::filesystem::path cache() const { return path_ / ".cache"; }
  [[nodiscard]] std::filesystem::path outside(const std::string& name) const { return folder_ / name; }

  /// The files of the cache that hold a factor.
  [[nodiscard]] std::vector<std::filesystem::path> factors() const {
    std::vector<std::filesystem::path> found;
    for (const auto& entry : std::filesystem::directory_iterator(cache())) {
      if (entry.path().filename().string().rfind("factor-", 0) == 0) found.push_back(entry.path());
    }
    return found;
  }

  /// `compueye run --board <this> ...`
  [[nodiscard]] std::vector<std::string> run_arguments(const std::vector<std::string>& more) const {
    std::vector<std::string> all{"run", "--board", path_.string()};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  [[nodiscard]] Ended run(const std::vector<std::string>& more) const { return compueye(run_arguments(more)); }

  /// The same with --json, which must work.
  nlohmann::json run_json(std::vector<std::string> more) const {
    more.emplace_back("--json");
    const Ended ended = run(more);
    REQUIRE_MESSAGE(ended.exit_code == 0, ended.err);
    const auto json = nlohmann::json::parse(ended.out, nullptr, false);
    REQUIRE_FALSE(json.is_discarded());
    return json;
  }

 private:
  TemporaryFolder folder_;
  std::filesystem::path path_;
};

/// Files below a folder whose name ends like that of a half-written one.
inline std::size_t partial_files(const std::filesystem::path& folder) {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    count += entry.path().extension() == ".partial" ? 1U : 0U;
  }
  return count;
}

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

inline std::ptrdiff_t lines(const std::string& text) {
  return std::count(text.begin(), text.end(), '\n');
}

}  // namespace compueye::test
