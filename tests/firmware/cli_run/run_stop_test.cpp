#include <doctest/doctest.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "firmware/files/npy.hpp"
#include "firmware/files/png.hpp"
#include "tests/firmware/cli_run/copied_board.hpp"
#include "tests/firmware/failure_check.hpp"

using namespace compueye;
using namespace compueye::test;

namespace {

/// Waits until the run has written something, which it does not before its first frame.
template <class Written>
bool under_way(Program& program, Written written) {
  // Bounded, because a busy machine may drop any one frame: ask for how many there are, never for a certain one.
  constexpr std::chrono::seconds limit{60};
  const auto began = std::chrono::steady_clock::now();
  while (program.running() && std::chrono::steady_clock::now() - began < limit) {
    if (written()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return false;
}

std::size_t pictures_in(const std::filesystem::path& folder) {
  std::error_code ignored;
  std::size_t count = 0;
  for (std::filesystem::directory_iterator at(folder, ignored), end; !ignored && at != end; at.increment(ignored)) {
    count += at->path().extension() == ".png" ? 1U : 0U;
  }
  return count;
}

}  // namespace

TEST_CASE("Ctrl-C ends a run with its summary, exit code 0 and a whole series of pictures") {
  for (const int number : {SIGINT, SIGTERM}) {
    const CopiedBoard board;
    const auto out = board.outside("out");
    Program program(board.run_arguments({"--frames", "0", "--out", out.string(), "--json"}));
    REQUIRE(under_way(program, [&] { return pictures_in(out) >= 4; }));
    program.signal(number);
    const Ended ended = program.wait();
    CHECK(ended.exit_code == 0);
    CHECK_FALSE(ended.timed_out);
    const auto json = nlohmann::json::parse(ended.out, nullptr, false);
    REQUIRE_FALSE(json.is_discarded());
    CHECK(json["ending"] == "stop requested");
    CHECK(json["frames"]["balanced"] == true);
    CHECK(json["frames"]["delivered"].get<int>() >= 4);
    CHECK(partial_files(out) == 0);
    std::uint64_t pictures = 0;
    for (const auto& entry : std::filesystem::directory_iterator(out)) {
      if (entry.path().filename() == "frames.csv") continue;
      CHECK(firmware::read_png(entry.path()).has_value());
      ++pictures;
    }
    CHECK(pictures == json["frames"]["delivered"].get<std::uint64_t>());
    CHECK(static_cast<std::uint64_t>(lines(bytes_of(out / "frames.csv"))) == pictures + 1);
  }
}

TEST_CASE("the same signal within a moment is one, and a series of pictures ends whole") {
  const CopiedBoard board;
  const auto out = board.outside("out");
  Program program(board.run_arguments({"--frames", "0", "--out", out.string(), "--format", "npy", "--json"}));
  REQUIRE(under_way(program, [&] {
    if (!std::filesystem::exists(out)) return false;
    for (const auto& entry : std::filesystem::directory_iterator(out)) {
      std::error_code ignored;
      // Of a file that has just gone it is the largest number there is.
      const auto size = std::filesystem::file_size(entry.path(), ignored);
      if (!ignored && size > 8192) return true;
    }
    return false;
  }));
  for (int i = 0; i < 3; ++i) {
    program.signal(SIGINT);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  const Ended ended = program.wait();
  CHECK(ended.exit_code == 0);
  CHECK(partial_files(out) == 0);
  const auto pictures = firmware::read_pictures(out / "frames.npy");
  REQUIRE_MESSAGE(pictures.has_value(), pictures.error().text());
  const auto json = nlohmann::json::parse(ended.out, nullptr, false);
  REQUIRE_FALSE(json.is_discarded());
  CHECK(pictures->frames == json["frames"]["delivered"].get<std::int64_t>());
}

TEST_CASE("pictures of a run that is killed can be read, and say which frames they are") {
  const CopiedBoard board;
  const auto out = board.outside("out");
  Program program(board.run_arguments({"--frames", "0", "--out", out.string(), "--format", "npy"}));
  REQUIRE(under_way(program, [&] { return lines(bytes_of(out / "frames.csv")) > 8; }));
  program.signal(SIGKILL);
  CHECK(program.wait().exit_code == -1);
  const std::string bytes = bytes_of(out / "frames.npy");
  // What numpy does: as many as the header says, whatever stands behind them.
  const std::size_t at = bytes.find("'shape': (");
  REQUIRE(at != std::string::npos);
  const auto told = std::stoul(bytes.substr(at + 10));
  CHECK(told >= 8);
  CHECK(bytes.size() >= 128 + told * 16 * 16 * sizeof(float));
  const auto listed = static_cast<std::size_t>(lines(bytes_of(out / "frames.csv"))) - 1;
  CHECK(told >= listed);
  CHECK(told - listed <= 1);

  // Another run does not mix with it.
  const Ended again = board.run({"--frames", "2", "--out", out.string(), "--json"});
  check_failed_json(again, hal::ErrorCode::io, out.string(), {});
  CHECK(bytes_of(out / "frames.npy") == bytes);
}

TEST_CASE("two runs at once never share a folder") {
  const CopiedBoard board;
  const auto out = board.outside("out");
  Program first(board.run_arguments({"--frames", "0", "--out", out.string()}));
  REQUIRE(under_way(first, [&] { return pictures_in(out) > 0; }));
  const Ended second = board.run({"--frames", "2", "--out", out.string(), "--json"});
  check_failed_json(second, hal::ErrorCode::io, out.string(), {});
  first.signal(SIGTERM);
  const Ended ended = first.wait();
  CHECK(ended.exit_code == 0);
  // The summary says where they are.
  CHECK(contains(ended.out, (out / "frame-*.png").string()));
  CHECK(contains(ended.out, (out / "frames.csv").string()));
}
