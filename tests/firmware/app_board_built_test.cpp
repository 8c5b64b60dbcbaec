#include <doctest/doctest.h>

#include <string>
#include <string_view>

#include "firmware/eye/settings/board_lines.hpp"
#include "firmware/eye/settings/setting.hpp"
#include "hal/try.hpp"
#include "tests/firmware/app_board_text.hpp"
#include "tests/hal/error_check.hpp"

// What a board says of the eye as built and of its sensor besides codes.

using namespace compueye;
using namespace compueye::firmware;
using hal::ErrorCode;

namespace {

std::string with(std::string_view sensor, std::string_view build) {
  std::string text = firmware::test::good_board;
  if (!sensor.empty()) {
    text = firmware::test::replaced(text, "dead = [7, 3]\n", "dead = [7, 3]\n" + std::string(sensor) + "\n");
  }
  return build.empty() ? text : text + "[build]\n" + std::string(build) + "\n";
}

std::string keys_of(const std::vector<BoardDifference>& differences) {
  std::string keys;
  for (const BoardDifference& each : differences) keys += each.key + ":" + each.then + ">" + each.now + " ";
  return keys;
}

/// Whether hal takes the value too, and nothing but this setting being so small or large.
hal::Result<void> judged_by_hal(const Setting& setting, double value) {
  Board board = parse_board(firmware::test::good_board, "board.toml").value();
  board.detector.electrons_per_lsb = 1.0;
  board.detector.mux_channels = 2;
  board.detector.mux_slot_us = 1.0;
  setting.store(
      board, setting.type == SettingType::whole ? SettingValue(static_cast<std::int64_t>(value)) : SettingValue(value));
  TRY(board.build.validate());
  return board.detector.validate(65536);
}

}  // namespace

TEST_CASE("what is built and what is not stated are read") {
  const auto drawn = parse_board(with("", ""), "board.toml");
  REQUIRE(drawn.has_value());
  CHECK(drawn->build.seed == 1);
  CHECK(drawn->build.pose_rms_deg == 0.0);
  CHECK(drawn->build.dust_loss == 0.3);
  CHECK(drawn->detector.temperature_c == 25.0);
  CHECK(drawn->detector.electrons_per_lsb == 0.0);
  CHECK(drawn->detector.mux_order == hal::MuxOrder::neighbours);

  const auto built = parse_board(
      with("electrons_per_lsb = 20\nfull_well_e = 1e6\ndark_current_e_per_s = 50\nmux_channels = 8\nmux_slot_us = 2.5\n"
           "mux_order = \"interleaved\"\n"
           "mux_time_constant_us = 0.3\nspectral_response = [1, 0.5, 0]\nhot = [9, 2]\nhot_lsb = 40\nstuck = [5]\n"
           "blinking = []\nintegration_ms = 4",
           "seed = 77\npose_rms_deg = 0.3\nprofile = \"soft\"\nedge_order = 6\ncoma = 0.1\ndust_share = 0.15"),
      "board.toml");
  REQUIRE_MESSAGE(built.has_value(), built.error().text());
  CHECK(built->build.seed == 77);
  CHECK(built->build.pose_rms_deg == 0.3);
  CHECK(built->build.profile == hal::ProfileKind::soft);
  CHECK(built->build.edge_order == 6.0);
  CHECK(built->build.coma == 0.1);
  CHECK(built->build.dust_share == 0.15);
  CHECK(built->detector.electrons_per_lsb == 20.0);
  CHECK(built->detector.full_well_e == 1e6);
  CHECK(built->detector.mux_channels == 8);
  CHECK(built->detector.mux_order == hal::MuxOrder::interleaved);
  CHECK(built->detector.mux_slot_us == 2.5);
  CHECK(built->detector.mux_time_constant_us == 0.3);
  CHECK(built->detector.spectral_response == std::array<double, 3>{1.0, 0.5, 0.0});
  CHECK(built->detector.hot == std::vector<int>{2, 9});
  CHECK(built->detector.hot_lsb == 40.0);
  CHECK(built->detector.stuck == std::vector<int>{5});
  CHECK(built->detector.integration_ms == 4.0);
}

TEST_CASE("the ranges of a board file are those of hal") {
  int judged = 0;
  for (const Setting& setting : settings()) {
    const bool number = setting.type == SettingType::whole || setting.type == SettingType::real;
    if (!setting.as_built || !number || setting.key == "seed") continue;
    CAPTURE(std::string(setting.key));
    ++judged;
    // A multiplexer of none needs no slot: the least of either is judged by what needs it, below.
    const bool paired =
        setting.key == "mux_channels" || setting.key == "mux_slot_us" || setting.key == "electrons_per_lsb";
    if (!paired) CHECK(judged_by_hal(setting, setting.range.least).has_value());
    CHECK(judged_by_hal(setting, setting.range.most).has_value());
    const double beyond = setting.type == SettingType::whole ? 1.0 : 1e-3 * (1.0 + setting.range.most);
    const auto below = judged_by_hal(setting, setting.range.least - beyond);
    REQUIRE_FALSE(below.has_value());
    CHECK(below.error().code == ErrorCode::out_of_range);
    const auto above = judged_by_hal(setting, setting.range.most + beyond);
    REQUIRE_FALSE(above.has_value());
    CHECK(above.error().place == std::string(setting.section) + "." + std::string(setting.key));
  }
  CHECK(judged == 26);
}

TEST_CASE("what is built cannot contradict itself or be ignored") {
  struct Case {
    std::string_view sensor, build;
    int line;  // of the board with the line added
    compueye::test::Named named;
    ErrorCode code;
  };
  for (const Case& c : {
           Case{"", "edge_order = 6", 28, {"edge_order", "[build]", "soft"}, ErrorCode::mismatch},
           Case{"", "profile = \"airy\"\nedge_order = 6", 29, {"edge_order", "soft"}, ErrorCode::mismatch},
           Case{"", "dust_loss = 0.4", 28, {"dust_loss", "dust_share"}, ErrorCode::mismatch},
           Case{"", "profile = \"sofd\"", 28, {"profile", "soft"}, ErrorCode::not_found},
           Case{"", "dust = 0.1", 28, {"dust", "dust_loss"}, ErrorCode::not_found},
           Case{"", "pose_rms_deg = -1", 28, {"pose_rms_deg", "-1", "10"}, ErrorCode::out_of_range},
           Case{"", "pose_rms_deg = nan", 28, {"pose_rms_deg", "nan"}, ErrorCode::out_of_range},
           Case{"", "seed = -1", 28, {"seed", "-1"}, ErrorCode::out_of_range},
           Case{"full_well_e = 100", "", 19, {"full_well_e", "electrons_per_lsb"}, ErrorCode::mismatch},
           Case{"dark_current_e_per_s = 1", "", 19, {"dark_current_e_per_s", "electrons_per_lsb"}, ErrorCode::mismatch},
           Case{"mux_channels = 4", "", 19, {"mux_channels", "mux_slot_us"}, ErrorCode::mismatch},
           Case{"mux_channels = 81\nmux_slot_us = 1", "", 19, {"mux_channels", "80"}, ErrorCode::out_of_range},
           Case{"mux_slot_us = 4", "", 19, {"mux_slot_us", "mux_channels"}, ErrorCode::mismatch},
           Case{"mux_time_constant_us = 4", "", 19, {"mux_time_constant_us", "mux_channels"}, ErrorCode::mismatch},
           Case{"mux_order = \"interleaved\"", "", 19, {"mux_order", "mux_channels"}, ErrorCode::mismatch},
           Case{"mux_order = \"interlaced\"", "", 19, {"mux_order", "interleaved"}, ErrorCode::not_found},
           Case{"mux_channels = 80\nmux_slot_us = 100", "", 20, {"mux_slot_us", "7.9", "200"}, ErrorCode::mismatch},
           Case{"integration_ms = 5.1", "", 19, {"integration_ms", "5.1", "200"}, ErrorCode::mismatch},
           Case{"hot_lsb = 3", "", 19, {"hot_lsb", "hot"}, ErrorCode::mismatch},
           Case{"hot = [3]", "", 19, {"hot", "hot_lsb"}, ErrorCode::mismatch},
           Case{"hot = [80]\nhot_lsb = 3", "", 19, {"hot", "80", "79"}, ErrorCode::out_of_range},
           Case{"stuck = [3, 3]", "", 19, {"stuck", "3"}, ErrorCode::out_of_range},
           Case{"spectral_response = [1, 1]", "", 19, {"[red, green, blue]", "[1, 1]"}, ErrorCode::bad_format},
           Case{"spectral_response = [1, -1, 0]", "", 19, {"spectral_response", "-1"}, ErrorCode::out_of_range},
           Case{"spectral_response = [0, 0, 0]", "", 19, {"spectral_response", "0"}, ErrorCode::out_of_range},
       }) {
    CAPTURE(c.sensor);
    CAPTURE(c.build);
    compueye::test::check_error(parse_board(with(c.sensor, c.build), "board.toml"), c.code,
                                "board.toml:" + std::to_string(c.line), c.named);
  }
}

TEST_CASE("recordings tell an eye as built from one as drawn, and older ones are of an eye as drawn") {
  const Board drawn = parse_board(with("", ""), "board.toml").value();
  const Board built = parse_board(with("electrons_per_lsb = 20", "coma = 0.1"), "board.toml").value();
  // A recording from before there was anything to build has no such line.
  CHECK(board_lines(drawn).find("board.build") == std::string::npos);
  CHECK(board_lines(drawn).find("electrons") == std::string::npos);
  CHECK(board_lines(built).find("board.build.coma = 0.1\n") != std::string::npos);
  CHECK(keys_of(board_differences(board_lines(drawn), built)) ==
        "sensor.electrons_per_lsb:left out>20 build.coma:left out>0.1 ");
  CHECK(keys_of(board_differences(board_lines(built), drawn)) ==
        "sensor.electrons_per_lsb:20>left out build.coma:0.1>left out ");
}
