#include <doctest/doctest.h>

#include <fstream>

#include "tests/firmware/cli_run/copied_board.hpp"
#include "tests/firmware/cli_run/refused.hpp"

using namespace compueye;
using namespace compueye::test;

TEST_CASE("devices lists the boards there are and the broken ones with their error") {
  const CopiedBoard board;
  const auto boards = board.path().parent_path();
  std::filesystem::create_directory(boards / "broken");
  std::filesystem::copy_file(board.path() / "board.toml", boards / "broken" / "board.toml");
  std::string text = bytes_of(board.path() / "board.toml");
  text.replace(text.find("acceptance_angle_deg"), 20, "acceptence_angle_deg");
  std::ofstream(boards / "broken" / "board.toml") << text;

  const Ended ended = compueye::test::compueye({"devices", "--boards", boards.string()});
  CHECK(ended.exit_code == 0);
  CHECK(contains(ended.out, "SIM-8X8"));
  CHECK(names(ended.out, "acceptance_angle_deg?"));
  CHECK(contains(ended.out, "board's serial"));

  const Ended machine = compueye::test::compueye({"devices", "--boards", boards.string(), "--json"});
  const auto json = nlohmann::json::parse(machine.out, nullptr, false);
  REQUIRE_FALSE(json.is_discarded());
  REQUIRE(json["devices"].size() == 1);
  CHECK(json["devices"][0]["serial"] == "SIM-8X8");
  CHECK(json["devices"][0]["ommatidia"] == 64);
  CHECK(json["devices"][0]["bus"] == "sim");
  CHECK(json["broken"].size() == 1);
}

TEST_CASE("devices without a folder of boards says where it looked") {
  const CopiedBoard board;
  const std::string none = board.outside("none").string();
  check_refused({"devices", "--boards", none}, hal::ErrorCode::not_found, none, {"--boards"});
}
