#pragma once

#include <nlohmann/json.hpp>

#include "tests/hal/error_check.hpp"

namespace compueye::test {

/// Of all that a program says: a key that is left in braces names a figure that nothing has
/// (firmware/text/figures.hpp).
inline void check_no_key_left(const std::string& said) {
  const auto letter = [&](std::size_t at) { return at < said.size() && said[at] >= 'a' && said[at] <= 'z'; };
  std::size_t at = said.find('{');
  while (at != std::string::npos && !letter(at + 1)) at = said.find('{', at + 1);
  CHECK_MESSAGE(at == std::string::npos, said);
}

/// What a program that failed leaves: the exit code of `code`, and on stderr one line, "compueye: PLACE: SENTENCE".
/// With an empty `place` the values may be named anywhere in it. Returns "PLACE: SENTENCE". `Ended` is what a Program
/// gives.
template <class Ended>
std::string check_failure_told(const Ended& ended, hal::ErrorCode code, const std::string& place, const Named& named) {
  CHECK_FALSE(ended.timed_out);
  CHECK(ended.exit_code == (code == hal::ErrorCode::usage ? 2 : 1));
  const std::string who = "compueye: ", begin = place.empty() ? "" : place + ": ";
  REQUIRE(ended.err.starts_with(who));
  REQUIRE(ended.err.ends_with('\n'));
  const std::string told = ended.err.substr(who.size(), ended.err.size() - who.size() - 1);
  CHECK(told.starts_with(begin));
  check_sentence(told.starts_with(begin) ? told.substr(begin.size()) : told, named);
  return told;
}

/// The same, and nothing on stdout.
template <class Ended>
void check_failed(const Ended& ended, hal::ErrorCode code, const std::string& place, const Named& named) {
  CAPTURE(ended.err);
  check_failure_told(ended, code, place, named);
  CHECK(ended.out.empty());
}

/// The same of a program that was told --json: on stdout stands the error as an object, which says what stderr says.
template <class Ended>
void check_failed_json(const Ended& ended, hal::ErrorCode code, const std::string& place, const Named& named) {
  CAPTURE(ended.err);
  CAPTURE(ended.out);
  const std::string told = check_failure_told(ended, code, place, named);
  const auto json = nlohmann::json::parse(ended.out, nullptr, false);
  REQUIRE(json.contains("error"));
  const nlohmann::json& error = json["error"];
  CHECK(error["code"] == hal::name(code));
  const auto there = error["place"].template get<std::string>(),
             sentence = error["sentence"].template get<std::string>();
  CHECK((there.empty() ? "" : there + ": ") + sentence == told);
}

}  // namespace compueye::test
