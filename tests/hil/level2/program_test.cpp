// `run`, `record` and `devices` in front of an emulated eye: what an operator and a test engineer do. In this process,
// because the emulated device files read their caller's memory.

#include <doctest/doctest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "drivers/recording/recording_reader.hpp"
#include "firmware/app/commands/devices.hpp"
#include "firmware/app/commands/run.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/hil/level2/benches.hpp"
#include "tests/source_folder.hpp"

namespace compueye::hil {
namespace {

using Json = nlohmann::json;
using firmware::RunOptions;

constexpr int channels = 64;

protocol::EmulatorSettings eye_of(const std::string& serial, const protocol::Bus* bus) {
  protocol::EmulatorSettings settings = eye(serial, channels, bus);
  settings.descriptor = protocol::tests::descriptor_of(channels, bus == &protocol::usb_bus ? 16 : 12);
  settings.descriptor.serial = serial;
  return settings;
}

std::string board(const std::string& name) {
  return compueye::test::source_path("boards/" + name);
}

hal::Result<void> run(const RunOptions& options) {
  firmware::Session session;
  return firmware::run_board(options, session);
}

/// What a run that has to succeed reports.
Json report_of(RunOptions options, const test::TemporaryFolder& folder) {
  options.report = (folder.path() / "report.json").string();
  const auto ran = run(options);
  REQUIRE_MESSAGE(ran.has_value(), ran.error().text());
  Json json = Json::parse(test::bytes_of(options.report), nullptr, false);
  std::filesystem::remove(options.report);
  REQUIRE_FALSE(json.is_discarded());
  return json;
}

/// A generic board in a folder of its own, where its cache may grow.
std::string copied(const std::string& name, const test::TemporaryFolder& folder) {
  std::filesystem::copy(board(name), folder.path() / name);
  return (folder.path() / name).string();
}

RunOptions options_of(const std::string& folder, std::int64_t frames) {
  RunOptions options;
  options.board = folder;
  options.frames = frames;
  options.show = false;
  return options;
}

void check_balanced(const Json& frames) {
  std::uint64_t dropped = 0;
  for (const auto& [reason, count] : frames["dropped"].items()) dropped += count.get<std::uint64_t>();
  CHECK(frames["produced"].get<std::uint64_t>() == frames["delivered"].get<std::uint64_t>() + dropped);
}

/// No file of this process grows beyond so many bytes, as if the disk were full.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    REQUIRE(getrlimit(RLIMIT_FSIZE, &before_) == 0);
    const rlimit limited{bytes, before_.rlim_max};
    REQUIRE(setrlimit(RLIMIT_FSIZE, &limited) == 0);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_{};
  void (*handler_)(int);
};

/// Standard output is a pipe whose reader sleeps until `wakes()`.
class SleepingReader {
 public:
  template <class Wakes>
  explicit SleepingReader(Wakes wakes) : before_(::dup(STDOUT_FILENO)) {
    std::array<int, 2> ends{};
    REQUIRE(::pipe(ends.data()) == 0);
    REQUIRE(::dup2(ends[1], STDOUT_FILENO) == STDOUT_FILENO);
    ::close(ends[1]);
    reader_ = std::thread([from = ends[0], wakes] {
      static_cast<void>(wait_until(wakes));
      std::array<char, 4096> read{};
      while (::read(from, read.data(), read.size()) > 0) {
      }
      ::close(from);
    });
  }
  SleepingReader(const SleepingReader&) = delete;
  SleepingReader& operator=(const SleepingReader&) = delete;
  ~SleepingReader() {
    ::dup2(before_, STDOUT_FILENO);
    ::close(before_);
    reader_.join();
  }

 private:
  int before_;
  std::thread reader_;
};

}  // namespace

TEST_CASE("program: devices lists what is attached, with what the eyes say of themselves") {
  HIL_TESTBED(testbed);
  UsbPort usb(testbed, eye_of("CE-USB", &protocol::usb_bus));
  HidPort hid(testbed, eye_of("CE-HID", &protocol::hid_bus));
  usb.plug();
  hid.plug();
  wait_for_boot(usb);
  wait_for_boot(hid);
  hal::MonotonicClock clock;
  const firmware::AttachedEyes attached = firmware::list_attached_eyes();
  CHECK(attached.notes.empty());
  const firmware::Figures report = firmware::devices_report(attached, "boards", {});
  const Json json = Json::parse(firmware::json_text(report));
  REQUIRE(json["attached"].size() == 2);
  for (std::size_t i = 0; i < 2; ++i) {
    const Json& found = json["attached"][i];
    INFO(found.dump());
    REQUIRE_FALSE(found.contains("error"));
    CHECK(found["serial"] == (i == 0 ? "CE-USB" : "CE-HID"));
    CHECK(found["kind"] == (i == 0 ? "usb" : "hid"));
    CHECK(found["firmware"] == "1.2.3");
    CHECK(found["ommatidia"] == channels);
    CHECK(found["bits"] == (i == 0 ? 16 : 12));
  }
  const std::string text = report.text();
  CHECK(text.find("CE-USB") != std::string::npos);
  CHECK(text.find("hidraw") != std::string::npos);
}

TEST_CASE("program: run streams frames from an eye on USB and on HID") {
  HIL_TESTBED(testbed);
  UsbPort usb(testbed, eye_of("CE-USB", &protocol::usb_bus));
  HidPort hid(testbed, eye_of("CE-HID", &protocol::hid_bus));
  usb.plug();
  hid.plug();
  wait_for_boot(usb);
  wait_for_boot(hid);
  const test::TemporaryFolder folder;
  for (const std::string name : {"generic-usb", "generic-hid"}) {
    CAPTURE(name);
    const Json json = report_of(options_of(copied(name, folder), 60), folder);
    INFO(json.dump());
    CHECK(json["frames"]["delivered"].get<int>() == 60);
    check_balanced(json["frames"]);
  }
}

TEST_CASE("program: what was recorded on USB replays into the same pictures every time") {
  HIL_TESTBED(testbed);
  UsbPort usb(testbed, eye_of("CE-USB", &protocol::usb_bus));
  usb.plug();
  wait_for_boot(usb);
  const test::TemporaryFolder folder;
  RunOptions options = options_of(copied("generic-usb", folder), 40);
  options.format = "png16";
  options.record = (folder.path() / "eye.rec").string();
  options.out = (folder.path() / "live").string();
  report_of(options, folder);
  usb.unplug();
  options.replay = options.record;
  options.record.clear();
  options.frames = 0;  // live, the newest frames won; a replay takes all
  for (const char* again : {"first", "second"}) {
    options.out = (folder.path() / again).string();
    report_of(options, folder);
    std::size_t compared = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path() / "live")) {
      CAPTURE(entry.path().filename());
      if (entry.path().extension() != ".png") continue;  // frames.csv has other times
      const bool same =
          test::bytes_of(entry.path()) == test::bytes_of(std::filesystem::path(options.out) / entry.path().filename());
      CHECK(same);
      ++compared;
    }
    CHECK(compared == 40);
  }
}

TEST_CASE("program: a run goes on when the eye is plugged in again") {
  HIL_TESTBED(testbed);
  UsbPort usb(testbed, eye_of("CE-USB", &protocol::usb_bus));
  usb.plug();
  wait_for_boot(usb);
  const test::TemporaryFolder folder;
  // Unplugged when the trial frame of the set-up is long over and the run is under way.
  const auto frames_made = [&] { return usb.cable.with([](auto& device, auto) { return device.truth().frames; }); };
  std::thread hand([&] {
    for (int k = 0; k < 10'000 && frames_made() < 300; ++k) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    usb.unplug();
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    usb.plug();
  });
  const Json json = report_of(options_of(copied("generic-usb", folder), 1500), folder);
  hand.join();
  INFO(json.dump());
  CHECK(json["frames"]["delivered"].get<int>() == 1500);
  // The first frame of a device that has started anew has no time to compare with.
  CHECK(json["health"]["untrusted_times"].get<int>() == 1);
  CHECK(json["health"]["config_mismatches"].get<int>() == 0);
  CHECK(json["source_counters"]["unplugged"].get<int>() == 1);
  CHECK(json["source_counters"]["rebooted"].get<int>() == 1);
  CHECK(json["source_counters"]["gave_up"].get<int>() == 0);
  check_balanced(json["frames"]);
}

TEST_CASE(
    "program: the books balance when the eye is pulled, the disk is full and nobody reads the view, all at once") {
  HIL_TESTBED(testbed);
  UsbPort usb(testbed, eye_of("CE-USB", &protocol::usb_bus));
  usb.plug();
  wait_for_boot(usb);
  const test::TemporaryFolder folder;
  RunOptions options = options_of(copied("generic-usb", folder), 900);
  options.report = (folder.path() / "report.json").string();
  options.record = (folder.path() / "eye.rec").string();
  options.show = true;
  const auto frames_made = [&] { return usb.cable.with([](auto& device, auto) { return device.truth().frames; }); };
  std::thread hand([&] {
    static_cast<void>(wait_until([&] { return frames_made() >= 300; }));
    usb.cable.inject({.kind = protocol::FaultKind::short_read, .value = 20});
    usb.unplug();
    usb.plug();
  });
  hal::Result<void> ran;
  {
    const FullDisk full(64U << 10U);
    const SleepingReader reader([&] { return std::filesystem::exists(options.report); });
    ran = run(options);
  }
  hand.join();
  test::check_error(ran, hal::ErrorCode::no_space, options.record, {});
  const Json json = Json::parse(test::bytes_of(options.report), nullptr, false);
  INFO(json.dump());
  REQUIRE(json.is_object());
  CHECK(json["frames"]["delivered"].get<int>() == 900);
  CHECK(json["source_counters"]["unplugged"].get<int>() == 1);
  check_balanced(json["frames"]);

  auto recording = recording::RecordingReader::open(options.record);
  REQUIRE(recording);
  while (recording->next()) {
  }
  REQUIRE(recording->end());
  CHECK(recording->damage().bytes == 0);
  CHECK(recording->frames() > 0);
  CHECK(recording->unrecorded() > 0);
  CHECK(recording->account().balanced());
  CHECK(recording->account().produced <= json["frames"]["produced"].get<std::uint64_t>());
}

TEST_CASE("program: an eye that is not there, or does not fit the board, is an error that says so") {
  HIL_TESTBED(testbed);
  const auto absent = run(options_of(board("generic-usb"), 1));
  REQUIRE_FALSE(absent);
  CHECK(absent.error().code == hal::ErrorCode::not_found);
  protocol::EmulatorSettings settings = eye_of("CE-SMALL", &protocol::usb_bus);
  settings.descriptor = protocol::tests::descriptor_of(20, 16);
  settings.descriptor.serial = "CE-SMALL";
  UsbPort usb(testbed, settings);
  usb.plug();
  wait_for_boot(usb);
  test::check_error(run(options_of(board("generic-usb"), 1)), hal::ErrorCode::mismatch, "eye CE-SMALL",
                    {"generic-usb", "20", "64"});
  RunOptions lossless = options_of(board("generic-usb"), 1);
  lossless.lossless = true;
  CHECK(run(lossless).error().code == hal::ErrorCode::usage);
}

}  // namespace compueye::hil
