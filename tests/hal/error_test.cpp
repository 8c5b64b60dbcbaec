#include "hal/error.hpp"

#include <doctest/doctest.h>

#include <set>
#include <string>

#include "hal/result.hpp"

using namespace compueye::hal;

TEST_CASE("an error reads as place and sentence, whatever is missing") {
  CHECK(Error{ErrorCode::io, "a.npy", "is empty"}.text() == "a.npy: is empty");
  CHECK(Error{ErrorCode::io, "", "is empty"}.text() == "is empty");
  CHECK(Error{ErrorCode::not_found, "a.npy", ""}.text() == "a.npy: not found");
  CHECK(Error{ErrorCode::end_of_stream, "", ""}.text() == "end of stream");
}

TEST_CASE("every code has a name of its own") {
  std::set<std::string> names;
  const int codes = static_cast<int>(ErrorCode::interrupted) + 1;
  for (int i = 0; i < codes; ++i) names.insert(std::string(name(static_cast<ErrorCode>(i))));
  CHECK(names.size() == static_cast<std::size_t>(codes));
  CHECK(names.count("unknown") == 0);
}

TEST_CASE("results carry a value or the error they were made with") {
  const Result<int> good = 3;
  REQUIRE(good.has_value());
  CHECK(*good == 3);
  const Result<int> bad = fail(ErrorCode::mismatch, "y.npy", "has 63 samples, expected 64");
  REQUIRE_FALSE(bad.has_value());
  CHECK(bad.error().code == ErrorCode::mismatch);
  CHECK(bad.error().text() == "y.npy: has 63 samples, expected 64");
  const Result<int> late = timed_out();
  CHECK(late.error().code == ErrorCode::timeout);
  const Result<int> over = stream_ended();
  CHECK(over.error().code == ErrorCode::end_of_stream);
}
