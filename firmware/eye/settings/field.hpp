#pragma once

#include <algorithm>
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

template <class Kind>
std::vector<std::string_view> words_of(std::span<const recon::Named<Kind>> names) {
  std::vector<std::string_view> list;
  for (const recon::Named<Kind>& named : names) list.push_back(named.name);
  return list;
}

/// Of a word that is in the table, as a checked choice is.
template <class Kind>
Kind kind_of(std::span<const recon::Named<Kind>> names, std::string_view word) {
  const auto found =
      std::find_if(names.begin(), names.end(), [&](const recon::Named<Kind>& named) { return named.name == word; });
  return found == names.end() ? Kind{} : found->kind;
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
inline std::optional<SettingValue> shown(int member) {
  return SettingValue(std::int64_t{member});
}
inline std::optional<SettingValue> shown(double member) {
  return SettingValue(member);
}
inline std::optional<SettingValue> shown(const std::optional<double>& member) {
  return member ? shown(*member) : std::nullopt;
}
inline std::optional<SettingValue> shown(const std::string& member) {
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

/// The row of the member at the end of this path, field<&Board::eye, &hal::EyeGeometry::rows>({...}): numbers are
/// `whole` or `real`; texts keep the type that the row names. A row that shows itself keeps that.
template <auto... Path>
Setting field(Setting row) {
  using Member = std::remove_cvref_t<decltype(member_of<Path...>(std::declval<Board&>()))>;
  if constexpr (std::is_same_v<Member, int>) row.type = SettingType::whole;
  if constexpr (std::is_same_v<Member, double> || std::is_same_v<Member, std::optional<double>>) {
    row.type = SettingType::real;
  }
  row.store = [](Board& board, const SettingValue& value) { assign(member_of<Path...>(board), value); };
  if (row.show == nullptr) row.show = [](const Board& board) { return shown(member_of<Path...>(board)); };
  return row;
}

/// The same for one of a table of names.
template <auto Names, auto... Path>
Setting choice_field(Setting row) {
  row.type = SettingType::choice;
  row.choices = words_of(Names());
  row.store = [](Board& board, const SettingValue& value) {
    member_of<Path...>(board) = kind_of(Names(), text_of(value));
  };
  row.show = [](const Board& board) -> std::optional<SettingValue> {
    for (const auto& named : Names()) {
      if (named.kind == member_of<Path...>(board)) return SettingValue(std::string(named.name));
    }
    return std::nullopt;
  };
  return row;
}

}  // namespace compueye::firmware
