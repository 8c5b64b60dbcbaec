#include "firmware/eye/settings/board_lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>

#include "firmware/eye/settings/setting.hpp"
#include "firmware/text/words.hpp"
#include "xxhash.h"

namespace compueye::firmware {
namespace {

constexpr std::string_view prefix = "board.";
constexpr std::string_view left_out = "left out";

std::uint64_t hash_of(std::string_view text) {
  return XXH3_64bits(text.data(), text.size());
}

/// Whole, however short quoted() is: a long list by its length and hash.
std::string value_text(const SettingValue& value) {
  const std::string text = quoted(value);
  const auto* list = std::get_if<std::vector<std::int64_t>>(&value);
  if (list == nullptr || !text.ends_with("...]")) return text;
  return fmt::format("{} {} of them, {:016x}", text, list->size(), hash_of(fmt::format("{}", fmt::join(*list, ","))));
}

using Lines = std::map<std::string, std::string, std::less<>>;

bool says_which_eye(const Setting& setting) {
  return setting.section == "eye" || setting.section == "object" || setting.section == "sensor" || setting.as_built;
}

/// Of the settings that matter, by key. What is as drawn has no line: recordings are older than those settings.
Lines lines_of(const Board& board) {
  Lines lines;
  for (const Setting& setting : settings()) {
    if (!says_which_eye(setting)) continue;
    const auto value = setting.show(board);
    if (setting.as_built && value == setting.fallback) continue;
    lines.emplace(fmt::format("{}{}.{}", prefix, setting.section, setting.key),
                  value ? value_text(*value) : std::string(left_out));
  }
  return lines;
}

Lines parsed(std::string_view text) {
  Lines lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    constexpr std::string_view equals = " = ";
    const std::size_t at = line.find(equals);
    if (at != std::string_view::npos) lines.emplace(line.substr(0, at), line.substr(at + equals.size()));
  }
  return lines;
}

}  // namespace

std::string board_lines(const Board& board) {
  std::string settings;
  for (const auto& [key, value] : lines_of(board)) settings += fmt::format("{} = {}\n", key, value);
  return fmt::format("board = {}\ndistance_mm = {}\nboard_hash = {:016x}\n", visible_text(board.name),
                     board.object.distance_mm, hash_of(settings)) +
         settings;
}

std::vector<BoardDifference> board_differences(std::string_view lines, const Board& board) {
  const Lines then = parsed(lines), now = lines_of(board);
  std::vector<BoardDifference> differences;
  const auto compare = [&](const std::string& key, const std::string& before, const std::string& after) {
    if (before != after) differences.push_back({key, visible_text(before), after});
  };
  if (!then.contains("board_hash")) {
    // An older recording knows these two.
    const Lines two{{"board", board.name}, {"distance_mm", fmt::format("{}", board.object.distance_mm)}};
    for (const auto& [key, value] : two) {
      if (const auto at = then.find(key); at != then.end()) compare(key, at->second, value);
    }
    return differences;
  }
  const auto in = [](const Lines& all, const std::string& key) {
    const auto at = all.find(key);
    return at == all.end() ? std::string(left_out) : at->second;
  };
  for (const Setting& setting : settings()) {
    if (!says_which_eye(setting)) continue;
    const std::string key = fmt::format("{}.{}", setting.section, setting.key);
    compare(key, in(then, std::string(prefix) + key), in(now, std::string(prefix) + key));
  }
  return differences;
}

std::optional<std::string> value_in(std::string_view lines, std::string_view key) {
  const Lines all = parsed(lines);
  const auto at = all.find(key);
  return at == all.end() ? std::nullopt : std::optional(at->second);
}

std::string text_of(const std::vector<BoardDifference>& differences) {
  constexpr std::size_t most = 4;
  std::string text;
  for (std::size_t d = 0; d < std::min(differences.size(), most); ++d) {
    const BoardDifference& each = differences[d];
    text += fmt::format("{}{} was {} and is {}", d > 0 ? ", " : "", each.key, each.then, each.now);
  }
  if (differences.size() > most) text += fmt::format(", and {} more", differences.size() - most);
  return text;
}

}  // namespace compueye::firmware
