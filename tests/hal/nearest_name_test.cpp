#include "hal/nearest_name.hpp"

#include <doctest/doctest.h>

#include <array>
#include <string>
#include <string_view>
#include <vector>

using namespace compueye::hal;

TEST_CASE("edit distance counts insertions, deletions, replacements and swaps") {
  struct Case {
    std::string_view a, b;
    std::size_t distance;
  };
  for (const Case& c : {Case{"", "", 0}, Case{"", "abc", 3}, Case{"rows", "rows", 0}, Case{"ROWS", "rows", 0},
                        Case{"rosw", "rows", 1}, Case{"rws", "rows", 1}, Case{"roows", "rows", 1},
                        Case{"kitten", "sitting", 3}, Case{"acceptence", "acceptance", 1}}) {
    CAPTURE(c.a);
    CAPTURE(c.b);
    CHECK(edit_distance(c.a, c.b) == c.distance);
    CHECK(edit_distance(c.b, c.a) == c.distance);
  }
}

TEST_CASE("edit distance of enormous names stays bounded") {
  const std::string huge(100000, 'x');
  CHECK(edit_distance(huge, "rows") == 64);
  CHECK(edit_distance(huge, huge) == 0);
}

TEST_CASE("the nearest name is suggested, and none when none is near") {
  const std::array<std::string_view, 4> known{"rows", "columns", "radius_mm", "pitch_mm"};
  CHECK(nearest_name("row", known) == "rows");
  CHECK(nearest_name("colums", known) == "columns");
  CHECK(nearest_name("Radius_mm", known) == "radius_mm");
  CHECK_FALSE(nearest_name("temperature", known).has_value());
  CHECK_FALSE(nearest_name("", known).has_value());
  CHECK_FALSE(nearest_name("rows", {}).has_value());
  const std::array<std::string_view, 1> letter{"a"};
  CHECK_FALSE(nearest_name("b", letter).has_value());
  CHECK(did_you_mean("pich_mm", known) == "; did you mean 'pitch_mm'?");
  CHECK(did_you_mean("zzz", known).empty());
  CHECK(did_you_mean("rows", {}).empty());
  CHECK(suggestion("pich_mm", known) == "; did you mean 'pitch_mm'?");
  CHECK(suggestion("zzz", known) == "; known names are rows, columns, radius_mm, pitch_mm");
  CHECK(suggestion("zzz", letter) == "; the only known name is a");
  CHECK(suggestion("zzz", {}).empty());
  CHECK(suggestion("zzzzzz", std::vector<std::string_view>(21, "a")).ends_with(", a, ..."));
}
