// `run` on a board whose converters hang on this machine's SPI and GPIO, through the real spidev ABI and libgpiod.

#include <doctest/doctest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "firmware/app/commands/run.hpp"
#include "firmware/eye/board.hpp"
#include "firmware/eye/wired_eye.hpp"
#include "tests/drivers/device/converter_rig.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/hil/level2/benches.hpp"
#include "tests/hil/level2/converter_port.hpp"
#include "tests/hil/level2/wired_board.hpp"
#include "tests/source_folder.hpp"

namespace compueye::hil {

using device::tests::converter_eyes;
using device::tests::ConverterEye;
using device::tests::shown_code;

TEST_CASE("program: an eye of converters streams what they converted through spidev and libgpiod, and comes back") {
  HIL_TESTBED(testbed);
  for (const ConverterEye& each : converter_eyes) {
    const ConverterEye eye = slow(each);
    CAPTURE(eye.chip);
    ConverterPort port(testbed, device::tests::emulated(eye));
    const auto board = firmware::parse_board(board_text(eye, port), "board.toml");
    REQUIRE_MESSAGE(board.has_value(), board.error().text());
    hal::MonotonicClock clock;
    const auto source = firmware::wired_eye(*board, clock);
    REQUIRE_MESSAGE(source.has_value(), source.error().text());
    REQUIRE((*source)->start());
    // A busy machine may miss conversions, so they are looked up among all there can be.
    const auto check = [&](int frames) {
      for (int k = 0; k < frames;) {
        const auto block = (*source)->read(clock.now_ns() + patience_ns);
        REQUIRE_MESSAGE(block.has_value(), block.error().text());
        if (!whole(*block)) continue;
        ++k;
        std::optional<std::uint64_t> found;
        for (std::uint64_t back = 0; back < 20'000 && !found; ++back) {
          if (block->codes[5] == shown_code(back, 5, block->bits) &&
              block->codes[6] == shown_code(back, 6, block->bits)) {
            found = back;
          }
        }
        REQUIRE(found);
        for (std::size_t c = 0; c < block->codes.size(); ++c) {
          REQUIRE(block->codes[c] == shown_code(*found, c, block->bits));
        }
      }
    };
    check(10);
    port.inject({.kind = frontend::FrontEndFaultKind::gone, .duration_ns = 50'000'000});
    check(10);
    CHECK((*source)->account().balanced());
    (*source)->stop();
  }
}

TEST_CASE("program: run makes pictures of an eye of converters") {
  HIL_TESTBED(testbed);
  ConverterEye eye = slow(converter_eyes[3]);
  ConverterPort port(testbed, device::tests::emulated(eye));
  const compueye::test::TemporaryFolder folder;
  const auto board = folder.path() / "wired";
  std::filesystem::create_directory(board);
  std::ofstream(board / "board.toml") << board_text(eye, port);
  firmware::RunOptions options;
  options.board = board.string();
  options.frames = 20;
  options.show = false;
  options.report = (folder.path() / "report.json").string();
  firmware::Session session;
  const auto ran = firmware::run_board(options, session);
  REQUIRE_MESSAGE(ran.has_value(), ran.error().text());
  const auto json = nlohmann::json::parse(compueye::test::bytes_of(options.report));
  INFO(json.dump());
  CHECK(json["frames"]["delivered"].get<int>() == 20);
  CHECK(json["eye"]["source"].get<std::string>().starts_with("spi spidev"));
  CHECK(json["frames"]["balanced"].get<bool>());
}

}  // namespace compueye::hil
