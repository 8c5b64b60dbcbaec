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
#include "hal/eye_geometry.hpp"
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

inline std::array<double, 3> triple_of(const SettingValue& value) {
  if (const auto* whole = std::get_if<std::vector<std::int64_t>>(&value)) {
    return {static_cast<double>((*whole)[0]), static_cast<double>((*whole)[1]), static_cast<double>((*whole)[2])};
  }
  const auto& real = std::get<std::vector<double>>(value);
  return {real[0], real[1], real[2]};
}

/// How a member becomes a value and back, and the type of its row.
inline void assign(int& member, const SettingValue& value) {
  member = static_cast<int>(std::get<std::int64_t>(value));
}
inline void assign(std::int64_t& member, const SettingValue& value) {
  member = std::get<std::int64_t>(value);
}
inline void assign(std::uint64_t& member, const SettingValue& value) {
  member = static_cast<std::uint64_t>(std::get<std::int64_t>(value));
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
inline void assign(bool& member, const SettingValue& value) {
  member = std::get<bool>(value);
}
inline void assign(std::array<double, 3>& member, const SettingValue& value) {
  member = triple_of(value);
}
inline void assign(hal::Vec3& member, const SettingValue& value) {
  const auto [x, y, z] = triple_of(value);
  member = {x, y, z};
}
/// Channels, ascending.
inline void assign(std::vector<int>& member, const SettingValue& value) {
  const auto& list = std::get<std::vector<std::int64_t>>(value);
  member.assign(list.begin(), list.end());
  std::sort(member.begin(), member.end());
}
inline std::optional<SettingValue> value_of(int member) {
  return SettingValue(std::int64_t{member});
}
inline std::optional<SettingValue> value_of(std::int64_t member) {
  return SettingValue(member);
}
inline std::optional<SettingValue> value_of(std::uint64_t member) {
  return SettingValue(static_cast<std::int64_t>(member));
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
inline std::optional<SettingValue> value_of(bool member) {
  return SettingValue(member);
}
inline std::optional<SettingValue> value_of(const std::array<double, 3>& member) {
  return SettingValue(std::vector<double>(member.begin(), member.end()));
}
inline std::optional<SettingValue> value_of(const hal::Vec3& member) {
  return SettingValue(std::vector<double>{member.x, member.y, member.z});
}
inline std::optional<SettingValue> value_of(const std::vector<int>& member) {
  return SettingValue(std::vector<std::int64_t>(member.begin(), member.end()));
}

template <class Member>
constexpr SettingType type_of() {
  if constexpr (std::is_same_v<Member, double> || std::is_same_v<Member, std::optional<double>>) {
    return SettingType::real;
  } else if constexpr (std::is_same_v<Member, bool>) {
    return SettingType::flag;
  } else if constexpr (std::is_integral_v<Member>) {
    return SettingType::whole;
  } else if constexpr (std::is_same_v<Member, std::vector<int>>) {
    return SettingType::whole_list;
  } else if constexpr (std::is_same_v<Member, std::string>) {
    return SettingType::text;
  } else {
    return SettingType::real_tuple;
  }
}

template <auto First, auto... Rest>
auto& member_of(auto& object) {
  if constexpr (sizeof...(Rest) == 0) {
    return object.*First;
  } else {
    return member_of<Rest...>(object.*First);
  }
}

/// The kind of row that stores into a Target.
template <class Target>
struct RowFor {
  using Kind = SettingOf<Target>;
};
template <>
struct RowFor<Board> {
  using Kind = Setting;
};

/// A row as it is written down: what a word is not said of is as its kind has it.
template <class Target>
struct RowOf : RowFor<Target>::Kind {
  RowOf(std::string_view name, std::string_view what) {
    this->key = name;
    this->meaning = what;
  }
  RowOf& of(SettingType kind) { return this->type = kind, *this; }
  RowOf& within(Range allowed) { return this->range = allowed, *this; }
  RowOf& as(std::string_view tuple) { return this->parts = tuple, *this; }
  RowOf& one_of(std::vector<std::string_view> words) {
    return this->type = SettingType::choice, this->choices = std::move(words), *this;
  }
  RowOf& stated() { return this->required = true, *this; }
  RowOf& otherwise(SettingValue value) { return this->fallback = std::move(value), *this; }
  RowOf& otherwise(const char* word) { return otherwise(SettingValue(std::string(word))); }
  RowOf& otherwise(int number) { return otherwise(SettingValue(std::int64_t{number})); }
  RowOf& option_of(std::string_view takers, std::string_view name, std::string_view value) {
    return this->commands = takers, this->option = name, this->value_name = value, *this;
  }
  RowOf& shown_as(std::string_view name) { return this->figure = name, *this; }
  RowOf& stored(void (*how)(Target&, const SettingValue&), std::optional<SettingValue> (*back)(const Target&)) {
    return this->store = how, this->show = back, *this;
  }
  RowOf& shown(std::optional<SettingValue> (*how)(const Target&)) { return this->show = how, *this; }
  RowOf& overrules(void (*what)(Target&)) { return this->overrule = what, *this; }
  RowOf& only_of(bool (*solvers)(const recon::SolverRow&), std::string_view what) {
    return this->taken_by = solvers, this->feature = what, *this;
  }
};
using Row = RowOf<Board>;

template <class Class, class Member>
Class class_of(Member Class::*);
/// The class that a member belongs to.
template <auto First>
using TargetOf = decltype(class_of(First));

/// The row of the member at the end of this path, field<&Board::eye, &hal::EyeGeometry::rows>("rows", "..."); the type
/// is what the member's is.
template <auto First, auto... Rest>
RowOf<TargetOf<First>> field(std::string_view name, std::string_view meaning) {
  using Target = TargetOf<First>;
  using Member = std::remove_cvref_t<decltype(member_of<First, Rest...>(std::declval<Target&>()))>;
  return RowOf<Target>(name, meaning)
      .of(type_of<Member>())
      .stored([](Target& target, const SettingValue& value) { assign(member_of<First, Rest...>(target), value); },
              [](const Target& target) { return value_of(member_of<First, Rest...>(target)); });
}

/// The same for one of a table of names.
template <auto Names, auto First, auto... Rest>
RowOf<TargetOf<First>> choice_field(std::string_view name, std::string_view meaning) {
  using Target = TargetOf<First>;
  return RowOf<Target>(name, meaning)
      .one_of(recon::words_of(Names()))
      .stored(
          [](Target& target, const SettingValue& value) {
            member_of<First, Rest...>(target) = *recon::kind_of(Names(), text_of(value));
          },
          [](const Target& target) -> std::optional<SettingValue> {
            for (const auto& named : Names()) {
              if (named.kind == member_of<First, Rest...>(target)) return SettingValue(std::string(named.name));
            }
            return std::nullopt;
          });
}

/// The rows of a section.
template <class Target>
void add(std::vector<typename RowFor<Target>::Kind>& all, std::string_view section, std::vector<RowOf<Target>> rows) {
  for (RowOf<Target>& row : rows) {
    row.section = section;
    all.push_back(std::move(row));
  }
}
inline void add(std::vector<Setting>& all, std::string_view section, std::vector<Row> rows) {
  add<Board>(all, section, std::move(rows));
}

}  // namespace compueye::firmware
