#include "firmware/eye/settings/setting.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>
#include <string>

#include "tests/firmware/app_board_text.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye;
using namespace compueye::firmware;
using compueye::test::check_error;
using compueye::test::Named;

namespace {

const Setting& option(std::string_view name) {
  const auto rows = settings();
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const Setting& row) { return row.option == name; });
  REQUIRE(found != rows.end());
  return *found;
}

Board good_board() {
  auto board = parse_board(firmware::test::good_board, "board.toml");
  REQUIRE(board.has_value());
  return std::move(*board);
}

void check_refused(std::string_view name, std::string_view text, const Named& expected) {
  CAPTURE(name);
  CAPTURE(text);
  const auto refused = value_from(option(name), text, name);
  check_error(refused, hal::ErrorCode::usage, std::string(name), expected);
  CHECK(refused.error().sentence.find("'" + std::string(text) + "'") != std::string::npos);
}

}  // namespace

TEST_CASE("every option belongs to one row and to a command that takes it") {
  std::set<std::string_view> seen;
  for (const Setting& row : settings()) {
    CAPTURE(row.key);
    CHECK(row.option.empty() == row.commands.empty());
    CHECK(row.option.empty() == row.value_name.empty());
    if (row.section.empty()) CHECK_FALSE(row.option.empty());
    if (!row.option.empty()) CHECK(seen.insert(row.option).second);
  }
  for (const char* command : {"run", "compare", "reconstruct", "record", "simulate", "response"}) {
    CHECK_FALSE(settings_for(command).empty());
  }
  CHECK(settings_for("recon").empty());
  const auto of_run = settings_for("run");
  CHECK(std::find(of_run.begin(), of_run.end(), &option("--threads")) != of_run.end());
  CHECK(std::find(of_run.begin(), of_run.end(), &option("--rho")) == of_run.end());
}

TEST_CASE("what a board has is shown as its file would say it, and stored back as the same") {
  const Board board = good_board();
  for (const Setting& row : settings()) {
    if (row.section.empty()) continue;
    CAPTURE(row.key);
    const auto value = row.show(board);
    if (!value || *value == SettingValue(std::string())) continue;
    // A length that was not stated is no good value to state.
    if (row.key == "pitch_mm") continue;
    CHECK(check_value(row, *value).has_value());
    Board other = board;
    row.store(other, *value);
    const auto again = row.show(other);
    REQUIRE(again.has_value());
    CHECK(quoted(*again) == quoted(*value));
  }
  CHECK(find_setting("reconstruction", "lambda")->show(board) == std::nullopt);
  CHECK(find_setting("reconstruction", "rho")->show(board) == std::nullopt);
  CHECK(find_setting("reconstruction", "box")->show(board) == SettingValue(std::vector<double>{0.0, 1.5}));
  CHECK(find_setting("reconstruction", "operator")->show(board) == SettingValue(std::string("auto")));
  CHECK(find_setting("sensor", "dead")->show(board) == SettingValue(std::vector<std::int64_t>{3, 7}));
}

TEST_CASE("a command line has the last word, and errors name it") {
  Board board = good_board();
  board.lambda = 0.5;
  CHECK_FALSE(board.overrules("reconstruction", "iterations"));
  REQUIRE(set(board, option("--iterations"), "+17", "--iterations").has_value());
  CHECK(board.plan.iterations == 17);
  CHECK(board.overrules("reconstruction", "iterations"));
  CHECK(board.place("reconstruction", "iterations") == "--iterations");
  CHECK_FALSE(board.overrules("reconstruction", "box"));
  // The noise is what lambda is made from.
  REQUIRE(set(board, option("--sigma"), "0.25", "--sigma").has_value());
  CHECK(board.noise_sigma() == 0.25);
  CHECK_FALSE(board.lambda.has_value());
  REQUIRE(set(board, option("--lambda"), "3", "--lambda").has_value());
  CHECK(board.lambda == 3.0);
  REQUIRE(set(board, option("--operator"), "csr", "--operator").has_value());
  CHECK(board.plan.op == recon::OperatorKind::csr);
  REQUIRE(set(board, option("--operator"), "auto", "--operator").has_value());
  CHECK_FALSE(board.plan.op.has_value());
  board.objective.constraint = recon::ConstraintKind::none;
  REQUIRE(set(board, option("--box"), "-1,2.5", "--box").has_value());
  CHECK(board.objective.constraint == recon::ConstraintKind::box);
  CHECK(board.objective.lo == -1.0);
  CHECK(board.objective.hi == 2.5);
  REQUIRE(set(board, option("--precision"), "f64", "--precision").has_value());
  CHECK(board.plan.precision == recon::Precision::f64);
  REQUIRE(set(board, option("--start"), "warm", "--start").has_value());
  CHECK(board.plan.warm_start);
}

TEST_CASE("what is typed wrong is answered with what was typed and what was expected") {
  for (const char* text : {"0", "-5", "1000001", "2.5", "99999999999999999999", "", "ten"}) {
    check_refused("--iterations", text, {"1", "1000000"});
  }
  for (const char* text : {"-1", "nan", "inf", "1e999", "0.1x"}) {
    check_refused("--lambda", text, {"0"});
  }
  check_refused("--lambda", "1e13", {"1000000000000"});
  check_refused("--rho", "0", {"0"});
  check_refused("--rho", "1e-13", {"1e-12"});
  check_refused("--relaxation", "2", {"0", "2"});
  check_refused("--distance", "-3", {"0"});
  check_refused("--threads", "65", {"1", "64"});
  check_refused("--box", "1,0", {"0,1"});
  check_refused("--box", "1", {"0,1"});
  check_refused("--box", "0,nan", {"0,1"});
  check_refused("--solver", "amdm", {"admm?"});
  check_refused("--start", "hot", {"cold", "warm"});
  Board board = good_board();
  CHECK_FALSE(set(board, option("--iterations"), "0", "--iterations").has_value());
  CHECK(board.plan.iterations == 100);
  CHECK_FALSE(board.overrules("reconstruction", "iterations"));
}
