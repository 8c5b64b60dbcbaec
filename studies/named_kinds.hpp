#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/text/words.hpp"
#include "hal/result.hpp"
#include "recon/option_names.hpp"

namespace compueye::firmware {

/// The kinds that the words name, or all of them; in the table's order. Error usage: names the option, the word
/// and the nearest name.
template <class Kind>
[[nodiscard]] hal::Result<std::vector<Kind>> kinds_of(const char* option, const std::vector<std::string>& words,
                                                      std::span<const recon::Named<Kind>> table) {
  const std::vector<std::string_view> known = recon::words_of(table);
  for (const std::string& word : words) {
    if (recon::kind_of(table, word)) continue;
    return hal::fail(
        hal::ErrorCode::usage, option,
        fmt::format("is '{}', expected one of {}{}", word, fmt::join(known, ", "), suggestion(word, known)));
  }
  std::vector<Kind> kinds;
  for (const auto& named : table) {
    if (words.empty() || std::find(words.begin(), words.end(), named.name) != words.end()) kinds.push_back(named.kind);
  }
  return kinds;
}

}  // namespace compueye::firmware
