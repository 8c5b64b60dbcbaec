#include <doctest/doctest.h>
#include <signal.h>

#include <chrono>
#include <random>
#include <thread>

#include "drivers/recording/recording_format.hpp"
#include "drivers/recording/recording_reader.hpp"
#include "tests/firmware/cli_run/copied_board.hpp"

using namespace compueye;
using namespace compueye::test;

namespace {

std::uintmax_t size_of(const std::filesystem::path& file) {
  std::error_code error;
  const auto size = std::filesystem::file_size(file, error);
  return error ? 0 : size;
}

}  // namespace

TEST_CASE("a recording that is killed keeps every whole block that was written") {
  const CopiedBoard board;
  const auto whole = board.outside("whole.rec");
  // Samples depend on seed and frame number only, so this is what any recording of this eye holds.
  REQUIRE(test::compueye({"record", "--board", board.path().string(), "--frames", "30000", "--lossless", "--seed", "4",
                          "--out", whole.string()})
              .exit_code == 0);
  const std::size_t frame_bytes = recording::frame_block_bytes(64, 16);
  std::mt19937 random(20161116);
  std::uint64_t most = 0;
  for (int round = 0; round < 16; ++round) {
    CAPTURE(round);
    const auto file = board.outside("killed-" + std::to_string(round) + ".rec");
    std::vector<std::string> arguments{"record", "--board", board.path().string(), "--frames", "0", "--seed",
                                       "4",      "--out",   file.string()};
    // At the board's rate a block is rarely on its way when the signal comes; without pauses one nearly always is.
    if (round % 4 != 0) arguments.emplace_back("--lossless");
    Program program(arguments);
    const auto began = std::chrono::steady_clock::now();
    while (size_of(file) < 4 * frame_bytes && std::chrono::steady_clock::now() - began < std::chrono::seconds(60)) {
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 60'000));
    const std::uintmax_t seen = size_of(file);
    program.signal(SIGKILL);
    CHECK(program.wait().exit_code == -1);

    auto reader = recording::RecordingReader::open(file);
    REQUIRE_MESSAGE(reader.has_value(), reader.error().text());
    auto reference = recording::RecordingReader::open(whole);
    REQUIRE(reference);
    const std::uint64_t header_bytes = reader->position();
    std::uint64_t frames = 0;
    bool same = true;
    while (const auto frame = reader->next()) {
      same = same && frame->block.frame == frames++;
      const auto expected = reference->next();
      if (expected) {
        same = same && std::equal(frame->block.codes.begin(), frame->block.codes.end(), expected->block.codes.begin());
      }
    }
    CHECK(same);
    CHECK(header_bytes + (frames + 1) * frame_bytes > seen);
    CHECK(reader->damage().stretches == 0);
    CHECK(reader->damage().torn_bytes < frame_bytes);
    CHECK_FALSE(reader->end().has_value());
    most = std::max(most, frames);

    const Ended replayed = test::compueye({"replay", file.string()});
    CHECK(replayed.exit_code == 0);
    CHECK(contains(replayed.out, "cut off"));
  }
  CHECK(most > 100);
}
