#pragma once

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "tests/firmware/cli_run/program.hpp"

namespace compueye::test {

/// What a command line must fail with.
struct Refusal {
  int exit_code = 0;
  std::string code;   ///< of hal::ErrorCode
  std::string place;  ///< an option, or a part of a path
  std::string value;  ///< what the sentence must name; empty: nothing
};

/// With --json: a sentence on stderr, and on stdout an object with code, place and the value that was refused.
inline void check_refused(std::vector<std::string> arguments, const Refusal& expected) {
  arguments.emplace_back("--json");
  const Ended ended = compueye(arguments);
  CAPTURE(ended.out);
  CAPTURE(ended.err);
  CHECK(ended.exit_code == expected.exit_code);
  const auto json = nlohmann::json::parse(ended.out, nullptr, false);
  REQUIRE(json.contains("error"));
  const nlohmann::json& error = json["error"];
  const auto place = error["place"].get<std::string>(), sentence = error["sentence"].get<std::string>();
  CHECK(error["code"] == expected.code);
  CHECK(contains(place, expected.place));
  CHECK(contains(sentence, expected.value));
  CHECK(contains(ended.err, sentence));
}

}  // namespace compueye::test
