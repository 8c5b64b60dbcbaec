#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "hal/error.hpp"
#include "hal/result.hpp"

namespace compueye::test {

/// What a sentence has to name, in any order and in any words around it: numbers, options, keys, files, names. A name
/// that ends in '?' is one that the sentence proposes: "admm?" is "... 'admm'?".
using Named = std::vector<std::string>;

/// Whether `text` names `value` as a token of its own: 1 is not in 16, -1 or 0.1, and box is not in --box. A number may
/// be written with more zeros: 0.5 is in 0.500.
[[nodiscard]] inline bool names(std::string_view text, std::string_view value) {
  if (value.size() > 1 && value.back() == '?') {
    const std::string name(value.substr(0, value.size() - 1));
    return text.find(name + "'?") != std::string_view::npos || text.find(name + "\"?") != std::string_view::npos;
  }
  const auto of_word = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_' || c == '-';
  };
  const auto at = [&](std::size_t n) { return n < text.size() ? text[n] : ' '; };  // before the first wraps around
  if (value.empty()) return false;
  const bool opens = of_word(value.front()) || value.front() == '.', closes = of_word(value.back());
  const auto digits_after = value.find_first_not_of("0123456789", value.front() == '-' ? 1 : 0);
  const bool is_whole = digits_after == std::string_view::npos;
  const bool is_decimal = !is_whole && value[digits_after] == '.' && digits_after + 1 < value.size() &&
                          value.find_first_not_of("0123456789", digits_after + 1) == std::string_view::npos;
  for (std::size_t from = text.find(value); from != std::string_view::npos; from = text.find(value, from + 1)) {
    std::size_t end = from + value.size();
    if (is_whole && at(end) == '.' && at(end + 1) == '0') ++end;
    while ((is_decimal || end > from + value.size()) && at(end) == '0') ++end;
    const bool goes_back = of_word(at(from - 1)) || (at(from - 1) == '.' && of_word(at(from - 2)));
    const bool goes_on = of_word(at(end)) || (at(end) == '.' && of_word(at(end + 1)));
    if (!(opens && goes_back) && !(closes && goes_on)) return true;
  }
  return false;
}

/// Words with a blank between them are wording, which no test of an error may freeze. Quotes mark words of the input.
[[nodiscard]] inline bool is_wording(std::string_view value) {
  const auto letter = [](char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); };
  if (value.empty() || value.front() == '"') return value.empty();
  for (std::size_t n = 1; n + 1 < value.size(); ++n) {
    if (value[n] == ' ' && value[n - 1] != ',' && (letter(value[n - 1]) || letter(value[n + 1]))) return true;
  }
  return false;
}

/// Every value of `named` is in the sentence, which is one line.
inline void check_sentence(std::string_view sentence, const Named& named) {
  CAPTURE(sentence);
  CHECK_FALSE(sentence.empty());
  CHECK(std::none_of(sentence.begin(), sentence.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20U; }));
  for (const std::string& value : named) {
    CAPTURE(value);
    CHECK_FALSE(is_wording(value));
    CHECK(names(sentence, value));
  }
}

/// The code, the whole place, and the values that the sentence names; its words are free.
inline void check_error(const hal::Error& error, hal::ErrorCode code, const std::string& place, const Named& named) {
  CHECK(hal::name(error.code) == hal::name(code));
  CHECK(error.place == place);
  check_sentence(error.sentence, named);
}

template <class T>
void check_error(const hal::Result<T>& result, hal::ErrorCode code, const std::string& place, const Named& named) {
  REQUIRE_FALSE(result.has_value());
  check_error(result.error(), code, place, named);
}

}  // namespace compueye::test
