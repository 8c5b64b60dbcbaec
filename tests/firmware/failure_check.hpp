#pragma once

#include <nlohmann/json.hpp>

#include "tests/hal/error_check.hpp"

namespace compueye::test {

/// What a program that failed left behind: `ended` has exit_code, timed_out, out and err. On stderr stands one line,
/// "compueye: PLACE: SENTENCE", where an empty `place` leaves open where the values are named. On stdout stands
/// nothing, or the error as an object, with the same place and sentence: what --json asks for.
template <class Ended>
void check_failed(const Ended& ended, hal::ErrorCode code, const std::string& place, const Named& named) {
  CAPTURE(ended.out);
  CAPTURE(ended.err);
  CHECK_FALSE(ended.timed_out);
  CHECK(ended.exit_code == (code == hal::ErrorCode::usage ? 2 : 1));
  const std::string begin = "compueye: " + (place.empty() ? "" : place + ": ");
  REQUIRE(ended.err.starts_with(begin));
  REQUIRE(ended.err.ends_with('\n'));
  const std::string sentence = ended.err.substr(begin.size(), ended.err.size() - begin.size() - 1);
  check_sentence(sentence, named);
  if (ended.out.empty()) return;
  const auto json = nlohmann::json::parse(ended.out, nullptr, false);
  REQUIRE(json.contains("error"));
  const auto& error = json["error"];
  CHECK(error["code"] == hal::name(code));
  if (!place.empty()) CHECK(error["place"] == place);
  CHECK(sentence.ends_with(error["sentence"].template get<std::string>()));
}

/// The same of a program that was told --json: the object must be there.
template <class Ended>
void check_failed_json(const Ended& ended, hal::ErrorCode code, const std::string& place, const Named& named) {
  CHECK_FALSE(ended.out.empty());
  check_failed(ended, code, place, named);
}

}  // namespace compueye::test
