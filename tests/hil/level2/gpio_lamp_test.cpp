// Lamps on lines of a GPIO chip over the real libgpiod, 1.6 or 2 (COMPUEYE_LIBGPIOD).

#include <doctest/doctest.h>

#include <cerrno>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "drivers/illuminator/line_light.hpp"
#include "drivers/transport/gpio_gpiod.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/hil/level2/benches.hpp"
#include "tests/hil/level2/gpio_port.hpp"

namespace compueye::hil {
namespace {

using hal::ErrorCode;
using illuminator::LineLight;

/// Four lamps on lines 2, 3, 5 and the one called LAMP3, of eight.
struct LampBench {
  explicit LampBench(Testbed& testbed)
      : port(testbed, {{}, {}, {}, {}, {}, {}, {.name = "LAMP3"}, {.consumer = "fan"}}), chip(port.chip) {}

  [[nodiscard]] hal::Result<std::unique_ptr<LineLight>> make(bool active_low, std::string last = "LAMP3") {
    const transport::GpioOutputSettings lines{port.name(), {"2", "3", "5", std::move(last)}, active_low};
    return LineLight::create({2, 2, 0}, std::make_unique<transport::GpioOutputLines>(lines), clock);
  }
  /// Voltages of the lamps.
  [[nodiscard]] std::vector<bool> lit() const {
    return {chip.lines[2].level, chip.lines[3].level, chip.lines[5].level, chip.lines[6].level};
  }

  hal::MonotonicClock clock;
  GpioPort port;
  EmulatedGpiochip& chip;
};

}  // namespace

TEST_CASE("gpio: lamps show a picture in one call, are out before and behind it, and need not be lit by a high line") {
  HIL_TESTBED(testbed);
  for (const bool active_low : {false, true}) {
    CAPTURE(active_low);
    LampBench bench(testbed);
    const std::vector<bool> all_out(4, active_low);
    {
      const auto light = bench.make(active_low);
      REQUIRE_MESSAGE(light.has_value(), light.error().text());
      CHECK(bench.chip.last_interface() == COMPUEYE_LIBGPIOD);
      CHECK(bench.lit() == all_out);
      const std::size_t before = bench.chip.settings().size();
      REQUIRE((*light)->show(std::vector<float>{1.0F, 0.0F, 0.0F, 1.0F}));
      CHECK(bench.chip.settings().size() == before + 1);
      CHECK(bench.lit() == std::vector<bool>{!active_low, active_low, active_low, !active_low});
      REQUIRE((*light)->off());
      CHECK(bench.lit() == all_out);
      REQUIRE((*light)->show(std::vector<float>(4, 1.0F)));
      CHECK(bench.lit() == std::vector<bool>(4, !active_low));
    }
    CHECK(bench.lit() == all_out);
  }
}

TEST_CASE(
    "gpio: lamps that cannot be had or set are errors by name, and shine again when the chip does what it is told") {
  HIL_TESTBED(testbed);
  LampBench bench(testbed);
  test::check_error(bench.make(false, "7"), ErrorCode::io, bench.port.name() + " lines 2, 3, 5 and 7", {"fan", "7"});
  CHECK(bench.make(false, "LAMP9").error().code == ErrorCode::not_found);
  const auto light = bench.make(false).value();
  bench.chip.fail(EIO);
  CHECK(light->show(std::vector<float>(4, 1.0F)).error().code == ErrorCode::io);
  bench.chip.fail(0);
  REQUIRE(light->show(std::vector<float>(4, 1.0F)));
  CHECK(bench.lit() == std::vector<bool>(4, true));
  bench.chip.unplug();
  CHECK_FALSE(light->off());
}

}  // namespace compueye::hil
