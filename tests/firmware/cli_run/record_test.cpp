#include <doctest/doctest.h>
#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "tests/firmware/cli_run/copied_board.hpp"
#include "tests/firmware/cli_run/refused.hpp"

using namespace compueye;
using namespace compueye::test;
using compueye::hal::ErrorCode;

namespace {

nlohmann::json json_of(const Ended& ended) {
  REQUIRE_MESSAGE(ended.exit_code == 0, ended.err);
  const auto json = nlohmann::json::parse(ended.out, nullptr, false);
  REQUIRE_FALSE(json.is_discarded());
  return json;
}

nlohmann::json record(const CopiedBoard& board, const std::filesystem::path& file, std::vector<std::string> more) {
  more.insert(more.begin(), {"record", "--board", board.path().string(), "--out", file.string(), "--json"});
  return json_of(test::compueye(more));
}

nlohmann::json replay(const std::filesystem::path& file) {
  return json_of(test::compueye({"replay", file.string(), "--json"}));
}

}  // namespace

TEST_CASE("what was recorded is told by replay") {
  const CopiedBoard board;
  const auto file = board.outside("eye.rec");
  const auto recorded = record(board, file, {"--frames", "25", "--lossless", "--scene", "dots", "--seed", "9"});
  CHECK(recorded["frames_recorded"] == 25);
  CHECK(recorded["frames_unrecorded"] == 0);
  CHECK(recorded["file_bytes"] == std::filesystem::file_size(file));
  const auto told = replay(file);
  CHECK(told["frames"]["delivered"] == 25);
  CHECK(told["frames"]["balanced"] == true);
  CHECK(told["source"]["backend"] == "sim");
  CHECK(told["source"]["serial"] == "SIM-8X8");
  CHECK(told["source"]["channels"] == 64);
  CHECK(told["gaps"]["count"] == 0);
  CHECK(told["torn_tail"]["bytes"] == 0);
  CHECK(told["end"]["why"] == "stopped");
  CHECK(contains(told["settings"], "scene = dots\n"));
  CHECK(contains(told["settings"], "seed = 9\n"));
  const Ended text = test::compueye({"replay", file.string()});
  CHECK(contains(text.out, "25 produced = 25 recorded + 0 dropped"));
  CHECK(contains(text.out, "ended: stopped"));
}

TEST_CASE("a recorded run replays into the same pictures, bit for bit, at both paces") {
  const CopiedBoard board;
  const auto file = board.outside("eye.rec"), live = board.outside("live"), beside = board.outside("beside.rec");
  board.run_json({"--frames", "12", "--lossless", "--seed", "5", "--record", beside.string(), "--out", live.string(),
                  "--format", "npy"});
  record(board, file, {"--frames", "12", "--lossless", "--seed", "5"});
  const std::string pictures = bytes_of(live / "frames.npy");
  REQUIRE(pictures.size() > 12 * 16 * 16 * 4);
  int which = 0;
  for (const auto& recording : {beside, file}) {
    for (const std::string pace : {"fast", "recorded"}) {
      CAPTURE(pace);
      const auto again = board.outside("again-" + std::to_string(which++));
      const auto json = board.run_json(
          {"--replay", recording.string(), "--pace", pace, "--lossless", "--out", again.string(), "--format", "npy"});
      CHECK(json["frames"]["delivered"] == 12);
      CHECK(json["ending"] == "end of stream");
      CHECK(json["scene"] == "not known");
      CHECK(json["quality"].is_null());
      CHECK(bytes_of(again / "frames.npy") == pictures);
    }
  }
  const auto compared = board.run_json({"--replay", file.string(), "--scene", "fig2", "--frames", "5"});
  CHECK(compared["frames"]["delivered"] == 5);
  CHECK(compared["quality"]["nmse"].get<double>() < 1e-3);
}

TEST_CASE("a replay on another board, distance or dark level says which settings differ") {
  const CopiedBoard board;
  const auto file = board.outside("eye.rec");
  record(board, file, {"--frames", "3", "--lossless"});
  const auto notes_of = [&](const nlohmann::json& json) { return json["notes"].dump(); };
  const std::string none = notes_of(board.run_json({"--replay", file.string()}));
  CHECK_FALSE(contains(none, "eye.rec"));
  const std::string farther = notes_of(board.run_json({"--replay", file.string(), "--distance", "31"}));
  for (const char* value : {"object.distance_mm", "30", "31"}) CHECK(names(farther, value));
  CHECK_FALSE(contains(farther, "object.rows"));
  board.change("dark_level_lsb = 64", "dark_level_lsb = 200");
  const std::string darker = notes_of(board.run_json({"--replay", file.string()}));
  for (const char* value : {"sensor.dark_level_lsb", "64", "200"}) CHECK(names(darker, value));
}

TEST_CASE("a damaged and torn recording still runs, and the run says what is missing") {
  const CopiedBoard board;
  const auto file = board.outside("eye.rec");
  record(board, file, {"--frames", "12", "--lossless"});
  std::string bytes = bytes_of(file);
  const std::size_t frame = 124 + 8 + 128 + 4, first = bytes.size() - 128 - 12 * frame;
  bytes[first + 4 * frame + 77] ^= 2;
  bytes.resize(first + 11 * frame + 99);
  std::ofstream(file, std::ios::binary) << bytes;
  const Ended ended = board.run({"--replay", file.string(), "--json"});
  const auto json = json_of(ended);
  CHECK(json["frames"]["delivered"] == 10);
  CHECK(json["frames"]["dropped"]["corrupt"] == 1);
  CHECK(json["frames"]["balanced"] == true);
  CHECK(json["source_counters"]["damaged_frames"] == 1);
  CHECK(json["faults"] == 1);
  CHECK(json["source_counters"]["torn_bytes"] == 99);
  CHECK(json["source_counters"]["unrecorded_frames"] == 0);
  for (const std::size_t told : {std::size_t{99}, first + 11 * frame, first + 4 * frame}) {
    CHECK(names(ended.err, std::to_string(told)));
  }
  const auto told = replay(file);
  CHECK(told["torn_tail"]["bytes"] == 99);
  CHECK(told["damage"]["frames"] == 1);
  CHECK(told["gaps"]["missing_frames"] == 1);
  CHECK(told["end"].is_null());
}

TEST_CASE("a recording by time is about as long, and Ctrl-C keeps what there is") {
  const CopiedBoard board;
  const auto timed = board.outside("timed.rec"), stopped = board.outside("stopped.rec");
  const auto recorded = record(board, timed, {"--seconds", "0.4"});
  // However long it took: no sooner than asked, and no more than the eye's 200 frames a second and what its FIFO of 8
  // held when the time began.
  const double wall_s = recorded["wall_s"].get<double>();
  CHECK(wall_s >= 0.4);
  CHECK(recorded["ending"] == "enough recorded");
  CHECK(recorded["frames_recorded"].get<double>() >= 1.0);
  CHECK(recorded["frames_recorded"].get<double>() <= 200.0 * wall_s + 13.0);

  Program program({"record", "--board", board.path().string(), "--frames", "0", "--out", stopped.string(), "--json"});
  const auto began = std::chrono::steady_clock::now();
  std::error_code ignored;
  while ((!std::filesystem::exists(stopped) || std::filesystem::file_size(stopped, ignored) < 3000 || ignored) &&
         std::chrono::steady_clock::now() - began < std::chrono::seconds(60)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  program.signal(SIGINT);
  const auto json = json_of(program.wait());
  CHECK(json["ending"] == "stop requested");
  const auto told = replay(stopped);
  CHECK(told["frames"]["delivered"] == json["frames_recorded"]);
  CHECK(told["end"]["why"] == "stopped");
}

TEST_CASE("errors of recordings name the file and what is wrong") {
  const CopiedBoard board;
  const auto file = board.outside("eye.rec");
  const std::string at = board.path().string(), rec = file.string();
  record(board, file, {"--frames", "2", "--lossless"});
  const std::string bytes = bytes_of(file);
  const auto cut = board.outside("cut.rec"), flipped = board.outside("flipped.rec");
  std::ofstream(cut, std::ios::binary) << bytes.substr(0, 100);
  std::string damaged = bytes;
  damaged[60] ^= 1;
  std::ofstream(flipped, std::ios::binary) << damaged;
  const CopiedBoard other("sim-80x80");
  struct Case {
    std::vector<std::string> arguments;
    ErrorCode code;
    std::string place;
    Named named;
  };
  const std::vector<Case> cases{
      {{"record", "--board", at, "--out", rec}, ErrorCode::io, rec, {}},
      {{"run", "--board", at, "--record", rec}, ErrorCode::io, rec, {}},
      {{"record", "--board", at, "--out", "/dev/full"}, ErrorCode::no_space, "/dev/full", {}},
      {{"record", "--board", at, "--out", rec + "/x.rec"}, ErrorCode::not_found, rec + "/x.rec", {}},
      {{"record", "--board", at}, ErrorCode::usage, "--out", {"eye.rec"}},
      {{"record", "--board", at, "--out", "x.rec", "--seconds", "-1"}, ErrorCode::usage, "--seconds", {"-1"}},
      {{"record", "--board", at, "--out", "x.rec", "--seconds", "1", "--frames", "3"},
       ErrorCode::usage,
       "",
       {"--frames", "--seconds"}},
      {{"replay", rec + "x"}, ErrorCode::not_found, rec + "x", {}},
      {{"replay", at + "/board.toml"}, ErrorCode::bad_format, at + "/board.toml", {"0"}},
      {{"replay", cut.string()}, ErrorCode::bad_format, cut.string(), {"100"}},
      {{"replay", flipped.string()}, ErrorCode::bad_format, flipped.string(), {"CRC"}},
      {{"run", "--board", other.path().string(), "--replay", rec}, ErrorCode::mismatch, rec, {"64", "6400"}},
      {{"run", "--board", at, "--pace", "fast"}, ErrorCode::usage, "--pace", {"--replay"}},
      {{"run", "--board", at, "--replay", rec, "--seed", "3"}, ErrorCode::usage, "--seed", {"--replay"}},
      {{"run", "--board", at, "--replay", rec, "--record", "x.rec"}, ErrorCode::usage, "--record", {"--replay"}},
      {{"run", "--board", at, "--replay", rec, "--sheet", "x.png"}, ErrorCode::usage, "--sheet", {"--scene"}},
      {{"run", "--board", at, "--replay", rec, "--deadline", "5"},
       ErrorCode::usage,
       "--deadline",
       {"--pace", "recorded"}},
  };
  for (const Case& each : cases) {
    CAPTURE(each.place);
    check_refused(each.arguments, each.code, each.place, each.named);
  }
  CHECK(bytes_of(file) == bytes);
}

TEST_CASE("record and replay show how they are used") {
  for (const std::string command : {"record", "replay"}) {
    const Ended ended = test::compueye({command, "--help"});
    CHECK(ended.exit_code == 0);
    CHECK(contains(ended.out, "compueye " + command));
    CHECK(contains(ended.out, "--json"));
  }
}

TEST_CASE("a recording to standard output is nothing but the recording, by whatever name") {
  const CopiedBoard board;
  for (const char* const name : {"-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"}) {
    CAPTURE(name);
    for (const bool run : {false, true}) {
      const auto file = board.outside("copy.rec");
      const int out = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
      REQUIRE(out >= 0);
      const Ended ended = Program(run ? board.run_arguments({"--frames", "3", "--lossless", "--record", name})
                                      : std::vector<std::string>{"record", "--board", board.path().string(), "--frames",
                                                                 "3", "--lossless", "--out", name},
                                  out)
                              .wait();
      ::close(out);
      REQUIRE_MESSAGE(ended.exit_code == 0, ended.err);
      const auto told = replay(file);
      CHECK(told["frames"]["delivered"] == 3);
      // A run may be told of the end, or have its frames and stop first.
      const std::string why = told["end"]["why"];
      CHECK((why == "stopped" || (run && why == "end of stream")));
      CHECK(told["damage"]["bytes"] == 0);
      CHECK(names(ended.err, "frames"));
    }
  }
}
