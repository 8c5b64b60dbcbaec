#pragma once

#include <doctest/doctest.h>

#include <cstddef>
#include <string>

#include "drivers/frontend/front_end.hpp"
#include "tests/drivers/device/converter_rig.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/hil/level2/converter_port.hpp"
#include "tests/source_folder.hpp"

namespace compueye::hil {

/// board.toml of such an eye at such a port.
inline std::string board_text(const device::tests::ConverterEye& eye, const ConverterPort& port) {
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
inline device::tests::ConverterEye slow(device::tests::ConverterEye eye) {
  const bool own_pace = eye.chip == "ads131m08";
  eye.frame_rate_hz = own_pace ? 251.9685 : 20.0;
  if (own_pace) eye.chips = 1;
  return eye;
}

}  // namespace compueye::hil
