#include "hal/try.hpp"

#include <doctest/doctest.h>

#include <memory>

using namespace compueye::hal;

namespace {

Result<std::unique_ptr<int>> made(bool ok) {
  if (!ok) return fail(ErrorCode::io, "a.npy", "is empty");
  return std::make_unique<int>(3);
}

Result<void> asked(bool ok) {
  if (!ok) return fail(ErrorCode::usage, "--size", "is missing");
  return {};
}

Result<int> both(bool first, bool second, int& reached) {
  TRY(asked(first));
  reached = 1;
  const std::unique_ptr<int> value = TRY(made(second));
  reached = 2;
  return *value + *TRY(made(TRY(made(second)) != nullptr));
}

}  // namespace

TEST_CASE("TRY hands out the value of a result, one that can only be moved too") {
  int reached = 0;
  const Result<int> sum = both(true, true, reached);
  REQUIRE(sum.has_value());
  CHECK(*sum == 6);
}

TEST_CASE("TRY leaves the function with the error, before anything that comes after it") {
  int reached = 0;
  const Result<int> first = both(false, true, reached);
  REQUIRE_FALSE(first.has_value());
  CHECK(first.error().code == ErrorCode::usage);
  CHECK(reached == 0);
  const Result<int> second = both(true, false, reached);
  REQUIRE_FALSE(second.has_value());
  CHECK(second.error().place == "a.npy");
  CHECK(reached == 1);
}
