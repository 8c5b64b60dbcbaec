#include <doctest/doctest.h>

#include <fstream>
#include <string>
#include <vector>

#include "calib/eye_file/eye_file.hpp"
#include "firmware/app/commands/calibrate_report.hpp"
#include "firmware/calibration/calibration_run.hpp"
#include "firmware/calibration/plan_file.hpp"
#include "firmware/calibration/simulated_bench.hpp"
#include "tests/firmware/cli_run/copied_board.hpp"

using namespace compueye;
using namespace compueye::test;

namespace {

constexpr const char* short_plan =
    "[light]\nwarm_up_s = 0.5\nsettle_ms = 60\n[levels]\ndark_frames = 4\nblack_frames = 4\nflat_frames = 4\n"
    "ramp_steps = 0\n[patterns]\ncount = 40\n";

/// A session in a file that nothing was estimated from, as a stop while estimating leaves it.
void capture_only(const CopiedBoard& board, const std::string& eye) {
  const firmware::Board loaded = firmware::load_board(board.path()).value();
  const auto bench = firmware::SimulatedBench::create(loaded, firmware::plain_display(loaded), 0).value();
  auto file = calib::EyeFile::create(eye, {loaded.source.serial, loaded.eye, loaded.object}).value();
  firmware::CalibrationRequest request;
  request.plan = firmware::parse_plan(short_plan, "plan").value();
  request.distance_mm = 30.0;
  request.program = "test";
  REQUIRE(firmware::run_calibration(request, {*bench.eye, *bench.display, *bench.clock}, file,
                                    [](const calib::SessionProgress&) { return true; })
              .has_value());
  REQUIRE(file.close().has_value());
}

}  // namespace

TEST_CASE("what a session measured is estimated by --resume where a stop came before, and an eye runs with it") {
  const CopiedBoard board;
  const std::string eye = board.outside("a.eye").string(), path = board.path().string();
  capture_only(board, eye);
  const Ended made = test::compueye({"calibrate", "--board", path, "--eye", eye, "--resume", "--json"});
  REQUIRE_MESSAGE(made.exit_code == 0, made.err);
  const auto json = nlohmann::json::parse(made.out);
  CHECK(json["session"] == 1);
  CHECK(json["estimate"] == 1);
  CHECK(json["captures"] == calib::capture_schedule(firmware::parse_plan(short_plan, "plan").value(), 16, 16).size());
  CHECK(json["good_channels"].get<int>() >= 60);
  CHECK(json["row_error"].get<double>() < 0.05);
  const auto& budget = json["budget"];
  CHECK(budget["patterns"] == 40);
  CHECK(budget["nmse_noise"].get<double>() > 0.0);
  CHECK(budget["nmse_with_twice_the_patterns"].get<double>() < budget["nmse"].get<double>());
  double rows = 0.0;
  for (const auto& kind : budget["kinds"]) rows += kind["nmse"].get<double>();
  CHECK(budget["nmse_rows"].get<double>() == doctest::Approx(rows));
  // What was stored with the estimate is told again, to the digit.
  const Ended inspected = test::compueye({"inspect", eye, "--json"});
  REQUIRE_MESSAGE(inspected.exit_code == 0, inspected.err);
  CHECK(nlohmann::json::parse(inspected.out)["estimates"][0]["budget"] == budget);
  const Ended run = test::compueye({"run", "--board", path, "--eye", eye, "--frames", "5", "--lossless", "--json"});
  REQUIRE_MESSAGE(run.exit_code == 0, run.err);
  CHECK(nlohmann::json::parse(run.out)["quality"]["nmse"].get<double>() < 0.05);
  // Before the light that it was calibrated with it is as it was; a display whose black shines is not that light.
  const std::vector<std::string> check{"calibrate", "--board", path, "--eye", eye, "--check", "--seed", "3"};
  const Ended same = test::compueye(check);
  CHECK_MESSAGE(same.exit_code == 0, same.err);
  CHECK(contains(same.out, "ommatidia: none stands out"));
  const auto other = board.outside("other.toml");
  std::ofstream(other) << "[display]\nblack_level = 0.01\n[[surface]]\npicture = \"fig2\"\nshines = true\n";
  std::vector<std::string> changed = check;
  changed.insert(changed.end(), {"--scene", other.string(), "--json"});
  const Ended shining = test::compueye(changed);
  CHECK(shining.exit_code == 3);
  CHECK(contains(shining.err, "has changed"));
  CHECK(nlohmann::json::parse(shining.out)["gain"]["value"].get<double>() > 0.001);
  // Another distance goes into the same file, and neither stands for the other.
  const auto plan = board.outside("p.toml");
  std::ofstream(plan) << short_plan;
  const std::vector<std::string> nearer{"--board", path, "--eye", eye, "--distance", "28"};
  const auto with = [&](std::vector<std::string> all, const std::vector<std::string>& more) {
    all.insert(all.end(), nearer.begin(), nearer.end());
    all.insert(all.end(), more.begin(), more.end());
    return test::compueye(all);
  };
  const Ended before = with({"run"}, {"--frames", "1"});
  CHECK(before.exit_code == 1);
  CHECK(contains(before.err, "no estimate at 28 mm"));
  REQUIRE(with({"calibrate"}, {"--plan", plan.string()}).exit_code == 0);
  CHECK(with({"run"}, {"--frames", "1", "--lossless"}).exit_code == 0);
  // Nor are rows made between the two: the first was not taken by this command, and of another configuration.
  const Ended between =
      test::compueye({"run", "--board", path, "--eye", eye, "--frames", "1", "--lossless", "--distance", "29"});
  CHECK(between.exit_code == 1);
  CHECK(contains(between.err, "sessions at 28 and 30 mm, but with other settings"));
  CHECK(contains(test::compueye({"inspect", eye}).out, "between 28 and 30 mm"));
  const Ended again = test::compueye({"calibrate", "--board", path, "--eye", eye, "--resume"});
  CHECK(again.exit_code == 2);
  CHECK(contains(again.err, "--resume"));
}

TEST_CASE("an estimate that no picture should be trusted to is said to be one") {
  firmware::SessionEstimate made;
  made.rows.rows.resize(4);
  for (calib::RowEstimate& row : made.rows.rows) row.held_out_chi2 = 20.0;
  CHECK(firmware::doubt_of(made).empty());
  for (calib::RowEstimate& row : made.rows.rows) row.held_out_chi2 = 500.0;
  CHECK(contains(firmware::doubt_of(made), "chi^2 500"));
  for (calib::RowEstimate& row : made.rows.rows) row.held_out_chi2 = 20.0;
  for (std::size_t m = 1; m < 4; ++m) made.rows.rows[m].status = hal::ChannelStatus::does_not_fit;
  CHECK(contains(firmware::doubt_of(made), "1 of 4"));
}

TEST_CASE("a session of an eye that is not there, and before a light that it cannot see, leaves no file") {
  const CopiedBoard board;
  const auto eye = board.outside("a.eye");
  const std::vector<std::string> calibrate{"calibrate", "--board", board.path().string(), "--eye", eye.string()};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), calibrate.begin(), calibrate.end());
    return test::compueye(more);
  };
  const Ended display = with({"--light", "display"});
  CHECK(display.exit_code == 2);
  CHECK(contains(display.err, "--light"));
  CHECK(with({"--light", "lamp"}).exit_code == 2);
  const auto other_light = [&](const std::vector<std::string>& options) {
    const Ended ended = with(options);
    CHECK(ended.exit_code == 2);
    CHECK_MESSAGE(contains(ended.err, options[0] + ": means nothing to the light 'sim'"), ended.err);
  };
  other_light({"--monitor", "0"});
  other_light({"--window"});
  other_light({"--picture", "a.png"});
  CHECK(with({"--check", "--budget"}).exit_code == 2);
  const auto few = board.outside("few.toml");
  std::ofstream(few) << "[patterns]\ncount = 4\n";
  CHECK(contains(with({"--plan", few.string()}).err, "plan.held_out_every"));
  std::ofstream(few) << "[patterns]\nfamily = \"black\"\n";
  CHECK(contains(with({"--plan", few.string()}).err, "of the family black"));
  CHECK(contains(with({"--plan", ""}).err, "--plan"));
  board.change("full_scale = 128", "full_scale = 40");
  const Ended bright = with({});
  CHECK(bright.exit_code == 1);
  CHECK(contains(bright.err, "saturates"));
  board.change("full_scale = 40", "full_scale = 128");
  CHECK_FALSE(std::filesystem::exists(eye));
  board.change("kind = \"sim\"", "kind = \"usb\"");
  CHECK(with({"--light", "sim"}).exit_code == 2);
  CHECK(with({"--scene", "a.toml"}).exit_code == 2);
  CHECK(with({"--light", "manual", "--monitor", "0"}).exit_code == 2);
  CHECK(with({"--light", "device", "--picture", "a.png"}).exit_code == 2);
  const Ended absent = with({});
  CHECK(absent.exit_code == 1);
  CHECK(contains(absent.err, "SIM-8X8"));
  CHECK_FALSE(std::filesystem::exists(eye));
}
