// `calibrate` of an emulated eye on USB before a display, then `run` with what was measured, in real time: what a
// calibrator does. In this process, as program_test.cpp says.

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <variant>

#include "calib/eye_file/eye_file.hpp"
#include "firmware/app/command.hpp"
#include "firmware/app/commands/run.hpp"
#include "tests/drivers/illuminator/virtual_screen.hpp"
#include "tests/firmware/lit_eye.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/hil/level2/benches.hpp"

namespace compueye::hil {
namespace {

using compueye::test::LitEye;
using Json = nlohmann::json;

constexpr const char* short_plan =
    "[light]\nwarm_up_s = 0\nsettle_ms = 60\nsaturated_channels = 0\n[levels]\ndark_frames = 4\nblack_frames = 4\n"
    "flat_frames = 4\nramp_steps = 0\n[patterns]\ncount = 70\n[between]\nmost_retakes = 1000\n";

/// generic-usb as a board of LitEye.
std::string small_board(const compueye::test::TemporaryFolder& folder) {
  std::string text = compueye::test::bytes_of(compueye::test::source_path("boards/generic-usb/board.toml"));
  const auto change = [&](const std::string& before, const std::string& after) {
    for (std::size_t at = text.find(before); at != std::string::npos; at = text.find(before, at + after.size())) {
      text.replace(at, before.size(), after);
    }
  };
  change("rows = 8", "rows = 4");
  change("columns = 8", "columns = 4");
  change("rows = 16", "rows = 8");
  change("columns = 16", "columns = 8");
  change("bits = 16", "bits = 12");
  change("frame_rate_hz = 500", "frame_rate_hz = 200");
  const auto board = folder.path() / "lit";
  std::filesystem::create_directory(board);
  std::ofstream(board / "board.toml") << text;
  return board.string();
}

void set(firmware::OptionList& options, const std::string& name, const std::string& value) {
  const auto& target = std::get<firmware::Target>(options.at(name).target);
  if (auto* const maybe = std::get_if<std::optional<std::string>*>(&target)) {
    **maybe = value;
  } else {
    *std::get<std::string*>(target) = value;
  }
}

/// Calibrates the eye by `light` through the program, runs it as it was measured, and once more under checks.
void check_calibrated(Testbed& testbed, LitEye& eye, const std::string& light) {
  UsbPort usb(testbed, LitEye::settings(protocol::usb_bus), eye.samples());
  usb.plug();
  wait_for_boot(usb);
  const compueye::test::TemporaryFolder folder;
  const std::string board = small_board(folder), file = (folder.path() / "lit.eye").string();
  std::ofstream(folder.path() / "p.toml") << short_plan;

  const auto all = firmware::commands();
  const auto command = std::find_if(all.begin(), all.end(), [](const auto* each) { return each->name == "calibrate"; });
  firmware::OptionList options;
  const firmware::Action calibrate = (*command)->declare(options);
  set(options, "--board", board);
  set(options, "--eye", file);
  set(options, "--plan", (folder.path() / "p.toml").string());
  set(options, "--light", light);
  firmware::Session session;
  const auto done = calibrate(session);
  REQUIRE_MESSAGE(done.has_value(), done.error().text());

  const auto measured = calib::EyeFile::open(file, calib::EyeFileMode::read).value();
  CHECK(measured.eye().serial == "CE-LIT");
  const double exposure_s = measured.captures(1).value().next().value()->exposure_s.value();
  CHECK(exposure_s < 0.82 / 2.5 * LitEye::longest_ns * 1e-9);
  CHECK(exposure_s > 0.70 / 2.5 * LitEye::longest_ns * 1e-9);

  firmware::RunOptions run;
  run.board = board;
  run.frames = 20;
  run.show = false;
  run.report = (folder.path() / "report.json").string();
  const std::filesystem::path toml = std::filesystem::path(board) / "board.toml";
  std::string text = compueye::test::bytes_of(toml);
  text.replace(text.find("[board]\n"), 8, "[board]\neye = \"" + file + "\"\n");
  std::ofstream(toml) << text;
  firmware::Session running;
  const auto ran = firmware::run_board(run, running);
  REQUIRE_MESSAGE(ran.has_value(), ran.error().text());
  const Json json = Json::parse(compueye::test::bytes_of(run.report));
  INFO(json.dump());
  CHECK(json["frames"]["delivered"].get<int>() == 20);
  const auto exposed = usb.cable.with([](auto& device, std::int64_t now_ns) {
    std::array<std::byte, protocol::Configuration::bytes> bytes{};
    device.control(now_ns, protocol::number(protocol::Request::get_config), {}, bytes);
    return protocol::load_configuration(bytes).exposure_ns;
  });
  CHECK(exposed == static_cast<std::uint32_t>(std::llround(exposure_s * 1e9)));

  run.check_every_s = 0.2;
  run.light.kind = light;
  run.frames = 80;
  hal::Result<void> checked;
  for (int tries = 0; tries < 5; ++tries) {  // umockdev on a busy machine: an eye may not answer in its two seconds
    firmware::Session checking;
    checked = firmware::run_board(run, checking);
    if (checked || checked.error().code != hal::ErrorCode::timeout) break;
  }
  REQUIRE_MESSAGE(checked.has_value(), checked.error().text());
  const Json report = Json::parse(compueye::test::bytes_of(run.report));
  INFO(report["checks"].dump());
  CHECK(report["checks"]["looks"].get<int>() >= 1);
  // On a machine that is too busy to show a picture in its time a check may not look, and must not tell a change.
  const bool looked = report["checks"]["looks"].get<int>() > report["checks"]["could_not_look"].get<int>();
  CHECK(report["checks"]["last"].is_object() == looked);
  CHECK(report["checks"]["changes"].get<int>() == 0);
  CHECK(report["frames"]["checked"].get<int>() > 10);
  CHECK(report["frames"]["balanced"].get<bool>());
}

}  // namespace

TEST_CASE("program: an eye on USB is calibrated before a display, runs exposed as it was measured, and is checked") {
  HIL_TESTBED(testbed);
  const compueye::test::VirtualScreen screen;
  if (!screen.missing().empty()) {
    std::cout << "SKIPPED: " << screen.missing() << '\n';
    return;
  }
  LitEye eye(2.5);
  eye.noise_lsb = 1.0;
  eye.light = [&](std::size_t n) { return screen.level_of_square(n, 8, 8) / 255.0; };
  check_calibrated(testbed, eye, "display");
}

TEST_CASE("program: the same before the lamps of its own device") {
  HIL_TESTBED(testbed);
  LitEye eye(2.5);
  eye.noise_lsb = 1.0;
  check_calibrated(testbed, eye, "device");
}

}  // namespace compueye::hil
