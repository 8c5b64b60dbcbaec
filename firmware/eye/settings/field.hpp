#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "firmware/eye/settings/setting.hpp"
#include "recon/option_names.hpp"

namespace compueye::firmware {

// How a row stores into the board and shows what is there, where the setting is a member as it stands.

inline double real_of(const SettingValue& value) {
  const auto* whole = std::get_if<std::int64_t>(&value);
  return whole != nullptr ? static_cast<double>(*whole) : std::get<double>(value);
}
inline const std::string& text_of(const SettingValue& value) {
  return std::get<std::string>(value);
}

inline std::array<double, 2> pair_of(const SettingValue& value) {
  if (const auto* whole = std::get_if<std::vector<std::int64_t>>(&value)) {
    return {static_cast<double>((*whole)[0]), static_cast<double>((*whole)[1])};
  }
  const auto& real = std::get<std::vector<double>>(value);
  return {real[0], real[1]};
}

/// How a member of a board becomes a value and back, and the type of its row.
inline void assign(int& member, const SettingValue& value) {
  member = static_cast<int>(std::get<std::int64_t>(value));
}
inline void assign(double& member, const SettingValue& value) {
  member = real_of(value);
}
inline void assign(std::optional<double>& member, const SettingValue& value) {
  member = real_of(value);
}
inline void assign(std::string& member, const SettingValue& value) {
  member = text_of(value);
}
inline std::optional<SettingValue> value_of(int member) {
  return SettingValue(std::int64_t{member});
}
inline std::optional<SettingValue> value_of(double member) {
  return SettingValue(member);
}
inline std::optional<SettingValue> value_of(const std::optional<double>& member) {
  return member ? value_of(*member) : std::nullopt;
}
inline std::optional<SettingValue> value_of(const std::string& member) {
  return SettingValue(member);
}

template <auto First, auto... Rest>
auto& member_of(auto& object) {
  if constexpr (sizeof...(Rest) == 0) {
    return object.*First;
  } else {
    return member_of<Rest...>(object.*First);
  }
}

/// A row as it is written down: what a word is not said of is as Setting has it.
struct Row : Setting {
  Row(std::string_view name, std::string_view what) {
    key = name;
    meaning = what;
  }
  Row& of(SettingType kind) { return type = kind, *this; }
  Row& within(Range allowed) { return range = allowed, *this; }
  Row& one_of(std::vector<std::string_view> words) {
    return type = SettingType::choice, choices = std::move(words), *this;
  }
  Row& stated() { return required = true, *this; }
  Row& otherwise(SettingValue value) { return fallback = std::move(value), *this; }
  Row& otherwise(const char* word) { return otherwise(SettingValue(std::string(word))); }
  Row& otherwise(int number) { return otherwise(SettingValue(std::int64_t{number})); }
  Row& option_of(std::string_view takers, std::string_view name, std::string_view value) {
    return commands = takers, option = name, value_name = value, *this;
  }
  Row& shown_as(std::string_view name) { return figure = name, *this; }
  Row& stored(void (*how)(Board&, const SettingValue&), std::optional<SettingValue> (*back)(const Board&)) {
    return store = how, show = back, *this;
  }
  Row& shown(std::optional<SettingValue> (*how)(const Board&)) { return show = how, *this; }
  Row& overrules(void (*what)(Board&)) { return overrule = what, *this; }
  Row& only_of(bool (*solvers)(const recon::SolverRow&), std::string_view what) {
    return taken_by = solvers, feature = what, *this;
  }
};

/// The row of the member at the end of this path, field<&Board::eye, &hal::EyeGeometry::rows>("rows", "..."): a `whole`
/// or a `real` number, or a text.
template <auto... Path>
Row field(std::string_view name, std::string_view meaning) {
  using Member = std::remove_cvref_t<decltype(member_of<Path...>(std::declval<Board&>()))>;
  constexpr bool number = std::is_same_v<Member, double> || std::is_same_v<Member, std::optional<double>>;
  return Row(name, meaning)
      .of(std::is_same_v<Member, int> ? SettingType::whole
          : number                    ? SettingType::real
                                      : SettingType::text)
      .stored([](Board& board, const SettingValue& value) { assign(member_of<Path...>(board), value); },
              [](const Board& board) { return value_of(member_of<Path...>(board)); });
}

/// The same for one of a table of names.
template <auto Names, auto... Path>
Row choice_field(std::string_view name, std::string_view meaning) {
  return Row(name, meaning)
      .one_of(recon::words_of(Names()))
      .stored([](Board& board,
                 const SettingValue& value) { member_of<Path...>(board) = *recon::kind_of(Names(), text_of(value)); },
              [](const Board& board) -> std::optional<SettingValue> {
                for (const auto& named : Names()) {
                  if (named.kind == member_of<Path...>(board)) return SettingValue(std::string(named.name));
                }
                return std::nullopt;
              });
}

/// The rows of a section of board.toml.
inline void add(std::vector<Setting>& all, std::string_view section, std::vector<Row> rows) {
  for (Row& row : rows) {
    row.section = section;
    all.push_back(std::move(row));
  }
}

}  // namespace compueye::firmware
