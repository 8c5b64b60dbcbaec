#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "firmware/eye/settings/toml_value.hpp"
#include "recon/option_names.hpp"

namespace compueye::firmware {

// What a KeySpec::store makes of a value that passed its check.

inline double real_of(const TomlValue& value) {
  const auto* whole = std::get_if<std::int64_t>(&value);
  return whole != nullptr ? static_cast<double>(*whole) : std::get<double>(value);
}
inline int whole_of(const TomlValue& value) {
  return static_cast<int>(std::get<std::int64_t>(value));
}
inline const std::string& text_of(const TomlValue& value) {
  return std::get<std::string>(value);
}

inline std::array<double, 2> pair_of(const TomlValue& value) {
  if (const auto* whole = std::get_if<std::vector<std::int64_t>>(&value)) {
    return {static_cast<double>((*whole)[0]), static_cast<double>((*whole)[1])};
  }
  const auto& real = std::get<std::vector<double>>(value);
  return {real[0], real[1]};
}

template <class Kind>
std::vector<std::string_view> words(std::span<const recon::Named<Kind>> names) {
  std::vector<std::string_view> list;
  for (const recon::Named<Kind>& named : names) list.push_back(named.name);
  return list;
}

template <class Kind>
Kind kind_of(std::span<const recon::Named<Kind>> names, const TomlValue& value) {
  const auto found = std::find_if(names.begin(), names.end(),
                                  [&](const recon::Named<Kind>& named) { return named.name == text_of(value); });
  return found == names.end() ? Kind{} : found->kind;
}

}  // namespace compueye::firmware
