#include "tests/hal/error_check.hpp"

#include <doctest/doctest.h>

using compueye::test::is_wording;
using compueye::test::names;

TEST_CASE("a sentence names a value only where the value stands alone") {
  CHECK(names("rows is 16, expected 1 to 8", "16"));
  CHECK(names("ends after 8.", "8"));
  CHECK(names("shape (2, 3), at [7, 3]", "(2, 3)"));
  CHECK(names("16 or 1", "1"));
  CHECK_FALSE(names("rows is 16", "1"));
  CHECK_FALSE(names("rows is 16", "6"));
  CHECK_FALSE(names("is -1", "1"));
  CHECK_FALSE(names("is 0.1", "1"));
  CHECK_FALSE(names("is 1.5", "1"));
  CHECK_FALSE(names("is 1e-06", "1"));
  CHECK_FALSE(names("--box is", "box"));
  CHECK_FALSE(names("dense-runs-int8", "dense-runs"));
  CHECK_FALSE(names("x.npy", ".npy"));
  CHECK(names("expected '.npy'", ".npy"));
  CHECK(names("boards/mine/board.toml:3", "board.toml"));
  CHECK(names("is -0.500000", "-0.5"));
  CHECK(names("is 20.000000, expected", "20"));
  CHECK_FALSE(names("is 0.505", "0.5"));
  CHECK_FALSE(names("is 20.05", "20"));
  CHECK_FALSE(names("is 200", "20"));
  CHECK_FALSE(names("anything", ""));
}

TEST_CASE("a name is proposed only where the sentence asks about it") {
  CHECK(names("did you mean 'admm'?", "admm?"));
  CHECK(names("perhaps \"admm\"?", "admm?"));
  CHECK_FALSE(names("expected one of 'adm', 'admm'", "admm?"));
  CHECK_FALSE(names("did you mean 'admm'?", "adm?"));
}

TEST_CASE("words are told from values") {
  CHECK(is_wording("expected 1"));
  CHECK(is_wording("64 channels"));
  CHECK(is_wording("did you mean"));
  CHECK(is_wording(""));
  CHECK_FALSE(is_wording("[7, 3]"));
  CHECK_FALSE(is_wording("--lambda"));
}
