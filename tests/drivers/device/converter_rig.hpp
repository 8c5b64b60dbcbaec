#pragma once

#include <doctest/doctest.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "drivers/device/converter_source.hpp"
#include "drivers/frontend/emulated_front_end.hpp"
#include "drivers/frontend/emulated_wires.hpp"
#include "hal/clock.hpp"
#include "tests/hal/units.hpp"

namespace compueye::device::tests {

/// An eye of 64 channels of one kind of chip.
struct ConverterEye {
  std::string_view chip;
  int chips;
  double frame_rate_hz;
  bool tells_bits;    ///< a checksum: no turned bit is ever delivered
  bool tells_clocks;  ///< markers: no frame is delivered whose clocks were lost or doubled, or that began anew
};
inline constexpr ConverterEye converter_eyes[] = {{"mcp3208", 8, 200.0, false, false},
                                                  {"ads8688", 8, 500.0, false, true},
                                                  {"ads131m08", 8, 1000.0, true, true},
                                                  {"ddc264", 1, 1000.0, false, false}};

/// What channel `c` shows in conversion `index`: neither end of the scale, and different from conversion to conversion.
inline std::int32_t shown_code(std::uint64_t index, std::size_t channel, int bits) {
  std::uint64_t mixed = (index + 1) * 0x9E3779B97F4A7C15ULL + channel * 0xC2B2AE3D27D4EB4FULL;
  mixed ^= mixed >> 29U;
  mixed *= 0xBF58476D1CE4E5B9ULL;
  const auto most = (std::int64_t{1} << bits) - 2;
  return static_cast<std::int32_t>(1 +
                                   static_cast<std::int64_t>((mixed >> 20U) % static_cast<std::uint64_t>(most - 1)));
}

inline frontend::EmulatedFrontEndSettings emulated(const ConverterEye& eye) {
  frontend::EmulatedFrontEndSettings settings;
  settings.chip = frontend::find_front_end(eye.chip);
  REQUIRE(settings.chip != nullptr);
  settings.front_end.chips = eye.chips;
  settings.front_end.frame_rate_hz = eye.frame_rate_hz;
  settings.samples = [bits = settings.chip->bits](std::uint64_t index, std::span<std::int32_t> codes) {
    for (std::size_t c = 0; c < codes.size(); ++c) codes[c] = shown_code(index, c, bits);
  };
  return settings;
}

inline ConverterWires wires_of(frontend::EmulatedFrontEnd& front_end, hal::Clock& clock) {
  const frontend::FrontEndRow& chip = *front_end.settings().chip;
  ConverterWires wires;
  wires.data = std::make_unique<frontend::EmulatedSpiBus>(front_end, clock);
  if (chip.settings_bus) wires.settings = std::make_unique<frontend::EmulatedSpiBus>(front_end, clock, true);
  if (!chip.chain) {
    wires.select = std::make_unique<frontend::EmulatedOutputLines>(front_end, clock, frontend::OutputUse::select);
  }
  wires.reset = std::make_unique<frontend::EmulatedOutputLines>(front_end, clock, frontend::OutputUse::reset);
  if (chip.data_ready) wires.ready = std::make_unique<frontend::EmulatedEdgeLine>(front_end, clock);
  return wires;
}

inline ConverterSettings source_of(const frontend::EmulatedFrontEnd& front_end) {
  ConverterSettings settings;
  settings.chip = front_end.settings().chip;
  settings.front_end = front_end.settings().front_end;
  settings.serial = "CE-SPI";
  return settings;
}

/// An eye, its source, and what has come of it.
struct ConverterRig {
  explicit ConverterRig(const ConverterEye& eye, std::int64_t recovery_limit_ns = 30 * test::second)
      : front_end(emulated(eye), clock.now_ns()) {
    ConverterSettings settings = source_of(front_end);
    settings.recovery_limit_ns = recovery_limit_ns;
    auto made = ConverterSource::create(settings, wires_of(front_end, clock), clock);
    INFO((made ? "" : made.error().text()));
    REQUIRE(made);
    source = std::move(*made);
  }

  [[nodiscard]] std::int64_t period_ns() const {
    return static_cast<std::int64_t>(1e9 / front_end.settings().front_end.frame_rate_hz);
  }
  void inject(frontend::FrontEndFault fault) {
    fault.at_ns = clock.now_ns() + fault.at_ns;
    front_end.inject(fault);
  }
  /// Which conversion a block's good channels are of; nothing when they are of none or of several.
  [[nodiscard]] std::optional<std::uint64_t> conversion_of(const hal::SampleBlock& block) {
    const std::uint64_t newest = front_end.converted(clock.now_ns()) + 2;
    for (std::uint64_t back = 0; back < 40 && back <= newest; ++back) {
      bool same = true;
      for (std::size_t c = 0; same && c < block.codes.size(); ++c) {
        same = block.valid[c] == 0 || block.codes[c] == shown_code(newest - back, c, block.bits);
      }
      if (same) return newest - back;
    }
    return std::nullopt;
  }
  /// The next block, waited for until `within_ns` are over.
  [[nodiscard]] std::optional<hal::SampleBlock> next(std::int64_t within_ns = test::second) {
    const auto block = source->read(clock.now_ns() + within_ns);
    if (!block) {
      last_error = block.error();
      return std::nullopt;
    }
    return *block;
  }

  hal::VirtualClock clock{5 * test::second};
  frontend::EmulatedFrontEnd front_end;
  std::unique_ptr<ConverterSource> source;
  hal::Error last_error;
};

}  // namespace compueye::device::tests
