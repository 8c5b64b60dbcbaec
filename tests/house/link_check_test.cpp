#include "tests/house/link_check.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "tests/house/source_tree.hpp"

using namespace compueye::house;

namespace {

std::vector<Violation> check(std::string_view text) {
  return check_links(parse_link_lines(text));
}

}  // namespace

TEST_CASE("every target links only what the row of its folder allows") {
  const auto lines = parse_link_lines(read_text(COMPUEYE_LINK_LINES));
  const auto has = [&](std::string_view target) {
    return std::any_of(lines.begin(), lines.end(), [&](const LinkLine& line) { return line.target == target; });
  };
  CHECK(has("hal"));
  CHECK(has("recon"));
  CHECK(has("test_house"));
  const auto violations = check_links(lines);
  CHECK_MESSAGE(violations.empty(), "\n", list(violations));
}

TEST_CASE("a link line is read as target, sources and libraries") {
  const auto lines = parse_link_lines("hal|hal/a.cpp hal/b.cpp|Threads::Threads\nflags||\n\nbroken|line\n");
  REQUIRE(lines.size() == 2);
  CHECK(lines[0].target == "hal");
  CHECK(lines[0].sources == std::vector<std::string>{"hal/a.cpp", "hal/b.cpp"});
  CHECK(lines[0].links == std::vector<std::string>{"Threads::Threads"});
  CHECK(lines[1].sources.empty());
  CHECK(lines[1].links.empty());
}

TEST_CASE("forbidden links are caught, also behind another target") {
  const std::string good =
      "hal|hal/a.cpp|Threads::Threads compueye_flags\n"
      "recon|recon/a.cpp|hal Eigen3::Eigen PkgConfig::XXHASH\n"
      "usb|drivers/transport/usb.cpp|hal PkgConfig::LIBUSB\n"
      "eye_file|calib/eye_file/a.cpp|recon SQLite::SQLite3\n"
      "compueye|firmware/app/main.cpp|recon eye_file usb fmt::fmt\n";
  CHECK(check(good).empty());

  CHECK(check(good + "sim|sim/a.cpp|hal PkgConfig::LIBUSB\n").size() == 2);  // by its row, and as "never"
  CHECK(check(good + "sim|sim/a.cpp|hal usb\n").size() == 2);
  CHECK(check(good + "sim|sim/a.cpp|recon\n").size() == 2);  // recon itself, and Eigen behind it
  CHECK(check(good + "pipeline|firmware/pipeline/a.cpp|hal recon\n").empty());
  CHECK(check(good + "pipeline|firmware/pipeline/a.cpp|hal recon eye_file\n").size() == 2);
  CHECK(check(good + "sneaky||SQLite::SQLite3\npipeline|firmware/pipeline/a.cpp|sneaky\n").size() == 1);
  CHECK(check(good + "recon_core|recon/core/a.cpp|hal\n").size() == 1);
  CHECK(check(good + "files|firmware/files/a.cpp|boost_crc\n").size() == 1);
}

TEST_CASE("targets that link each other in a circle do not hang the check") {
  CHECK(check("a|hal/a.cpp|b\nb|hal/b.cpp|a\n").empty());
}
