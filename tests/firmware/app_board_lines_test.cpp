#include <doctest/doctest.h>

#include <string>

#include "firmware/eye/settings/board_lines.hpp"
#include "tests/firmware/app_board_text.hpp"

using namespace compueye::firmware;

namespace {

Board board_with(std::string_view old = "rows = 8\n", std::string_view with = "rows = 8\n") {
  auto board =
      parse_board(compueye::firmware::test::replaced(compueye::firmware::test::good_board, old, with), "board.toml");
  REQUIRE_MESSAGE(board.has_value(), board.error().text());
  return *board;
}

std::string hash_in(const std::string& lines) {
  const std::size_t at = lines.find("board_hash = ");
  REQUIRE(at != std::string::npos);
  return lines.substr(at + 13, 16);
}

std::string differing_keys(const std::vector<BoardDifference>& differences) {
  std::string keys;
  for (const BoardDifference& each : differences) keys += each.key + ":" + each.then + ">" + each.now + " ";
  return keys;
}

}  // namespace

TEST_CASE("a board's lines differ from another's in the settings that do, and their hash tells") {
  const Board board = board_with();
  const std::string lines = board_lines(board);
  CHECK(board_differences(lines, board).empty());
  struct Case {
    std::string_view old, with, differs;
  };
  for (const Case& c :
       {Case{"rows = 8\n", "rows = 9\n", "eye.rows:8>9 "},
        Case{"distance_mm = 30", "distance_mm = 30.5", "object.distance_mm:30>30.5 "},
        Case{"read_noise_lsb = 1", "read_noise_lsb = 1\ndark_level_lsb = 7", "sensor.dark_level_lsb:0>7 "},
        Case{"dead = [7, 3]", "dead = []", "sensor.dead:[3, 7]>[] "}}) {
    CAPTURE(c.with);
    const Board other = board_with(c.old, c.with);
    CHECK(differing_keys(board_differences(lines, other)) == c.differs);
    CHECK(hash_in(board_lines(other)) != hash_in(lines));
  }
  // What says nothing of a sample is no difference.
  const Board named = board_with("name = \"test-eye\"", "name = \"other\"");
  CHECK(board_differences(lines, named).empty());
  CHECK(hash_in(board_lines(named)) == hash_in(lines));
}

TEST_CASE("long lists differ beyond what is quoted of them") {
  const Board eight = board_with("dead = [7, 3]", "dead = [1, 2, 3, 4, 5, 6, 7, 8]");
  const Board other = board_with("dead = [7, 3]", "dead = [1, 2, 3, 4, 5, 6, 7, 9]");
  CHECK(board_differences(board_lines(eight), other).size() == 1);
  // Recordings keep it: another hash would call every older recording one of another board.
  CHECK(board_lines(eight).find("8 of them, abbb4481232324f7\n") != std::string::npos);
}

TEST_CASE("an older recording knows the board's name and distance, one of strangers nothing") {
  const Board board = board_with();
  CHECK(board_differences("board = test-eye\ndistance_mm = 30\nscene = dots\n", board).empty());
  CHECK(differing_keys(board_differences("board = dome\ndistance_mm = 10\n", board)) ==
        "board:dome>test-eye distance_mm:10>30 ");
  CHECK(board_differences("", board).empty());
  CHECK(board_differences("no line of ours", board).empty());
}
