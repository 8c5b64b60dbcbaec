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
#include "tests/source_folder.hpp"

namespace compueye::hil {
namespace {

using device::tests::converter_eyes;
using device::tests::ConverterEye;
using device::tests::shown_code;

/// board.toml of such an eye at such a port.
std::string board_text(const ConverterEye& eye, const ConverterPort& port) {
  const frontend::FrontEndRow& chip = *frontend::find_front_end(eye.chip);
  std::string text = compueye::test::bytes_of(compueye::test::source_path("boards/rpi4-spi-mcp3208/board.toml"));
  const auto change = [&](const std::string& key, const std::string& value) {
    const std::size_t at = text.find("\n" + key + " = ") + 1;
    REQUIRE(at != std::string::npos + 1);
    text.replace(at, text.find('\n', at) - at, value.empty() ? "" : key + " = " + value);
  };
  const int ommatidia = chip.channels * eye.chips;
  change("rows", std::to_string(ommatidia / 8));  // of [eye], which comes first
  change("bits", std::to_string(chip.bits));
  change("frame_rate_hz", std::to_string(eye.frame_rate_hz));
  change("chip", "\"" + std::string(eye.chip) + "\"");
  change("chips", std::to_string(eye.chips));
  change("data", "\"" + port.data() + "\"");
  change("clock_hz", "0");
  change("select", chip.chain || eye.chips == 1 ? "" : "\"" + port.gpiochip() + " 1 2 3\"");
  std::string more = "reset = \"" + port.gpiochip() + " 4\"\n";
  if (chip.data_ready) more += "data_ready = \"" + port.gpiochip() + " DRDY\"\n";
  if (chip.settings_bus) more += "settings = \"" + port.settings() + "\"\n";
  const std::size_t at = text.find("\nsync = ") + 1;
  return text.replace(at, text.find('\n', at) - at, more);
}

/// Slow enough for umockdev, which takes a thread's turn for each of the kernel's calls; one chip where it cannot be
/// slower.
ConverterEye slow(ConverterEye eye) {
  const bool own_pace = eye.chip == "ads131m08";
  eye.frame_rate_hz = own_pace ? 251.9685 : 20.0;
  if (own_pace) eye.chips = 1;
  return eye;
}

}  // namespace

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
