#pragma once

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "drivers/frontend/front_end.hpp"
#include "hal/clock.hpp"
#include "tests/drivers/frontend/bit_bus.hpp"

namespace compueye::frontend::tests {

using Chips = std::vector<std::unique_ptr<ChipEmulator>>;

inline Chips emulated(const FrontEndRow& row, int count) {
  Chips chips;
  for (int c = 0; c < count; ++c) chips.push_back(row.emulate());
  return chips;
}

/// Emulated chips on a bench with their front end.
struct ChipBench {
  ChipBench(const FrontEndRow& kind, const FrontEndSettings& wanted, Chips emulators)
      : row(kind), chips(std::move(emulators)), reset(1, pointers()) {
    for (const auto& chip : chips) chip->power_on();
    wiring = {.data = &bus,
              .settings = row.settings_bus ? &settings : nullptr,
              .select = row.chain ? nullptr : &select,
              .reset = &reset};
    auto made = row.make(wanted);
    REQUIRE_MESSAGE(made.has_value(), made.error().text());
    front_end = std::move(*made);
    const auto channels = static_cast<std::size_t>(front_end->channels());
    converted.resize(channels);
    codes.resize(channels);
    valid.resize(channels);
  }
  ChipBench(const FrontEndRow& kind, const FrontEndSettings& wanted)
      : ChipBench(kind, wanted, emulated(kind, wanted.chips)) {}

  [[nodiscard]] std::vector<ChipEmulator*> pointers() const {
    std::vector<ChipEmulator*> all;
    for (const auto& chip : chips) all.push_back(chip.get());
    return all;
  }

  void configure() {
    const auto done = front_end->configure(wiring, clock);
    REQUIRE_MESSAGE(done.has_value(), done.error().text());
  }

  /// Random light, from `least` on.
  void convert(std::int32_t least = 0) {
    std::uniform_int_distribution<std::int32_t> any(least, (1 << row.bits) - 1);
    for (auto& code : converted) code = any(random);
    convert_same();
  }
  void convert_same() {
    const auto each = static_cast<std::size_t>(row.channels);
    for (std::size_t c = 0; c < chips.size(); ++c) chips[c]->convert(std::span(converted).subspan(c * each, each));
  }

  FrameReport read(const BusFaults& faults = {}) {
    bus.arm(faults);
    for (const Exchange& exchange : front_end->frame()) {
      REQUIRE(select.set(exchange.select).has_value());
      REQUIRE(bus.exchange(exchange.segments).has_value());
    }
    bus.arm({.stuck = faults.stuck});
    return front_end->decode(codes, valid);
  }

  /// Of one chip's frame.
  [[nodiscard]] std::size_t bytes() const {
    std::size_t sum = 0;
    for (const auto& segment : front_end->frame().front().segments) sum += segment.bytes();
    return sum;
  }

  [[nodiscard]] bool right() const {
    for (const auto flag : valid) {
      if (flag == 0) return false;
    }
    return codes == converted;
  }
  [[nodiscard]] bool nothing_valid() const {
    for (std::size_t c = 0; c < codes.size(); ++c) {
      if (valid[c] != 0 || codes[c] != 0) return false;
    }
    return true;
  }

  const FrontEndRow& row;
  Chips chips;
  Lines select{4};
  Lines reset;
  BitBus bus{pointers(), row.chain, select.levels};
  SettingsBus settings{pointers()};
  Wiring wiring;
  hal::VirtualClock clock;
  std::unique_ptr<FrontEnd> front_end;
  std::mt19937 random{7};
  std::vector<std::int32_t> converted, codes;
  std::vector<std::uint8_t> valid;
};

/// The fault that all chips of a frame have; `none` where they differ is no answer, so that fails.
inline ChipFault fault_of(const FrameReport& report) {
  std::size_t found = 0, kinds = 0;
  for (std::size_t f = 0; f < chip_fault_count; ++f) {
    if (report.chips[f] == 0) continue;
    found = f;
    ++kinds;
  }
  CHECK(kinds == 1);
  return static_cast<ChipFault>(found);
}

/// What frames with one clock too few or too many told, at every clock of a frame.
struct SlipCount {
  int told = 0;
  int harmless = 0;  ///< not told, and every code is right
  int wrong = 0;     ///< not told, and a code is wrong
};

inline SlipCount slips(ChipBench& bench, bool lost) {
  SlipCount count;
  for (std::size_t at = 0; at < 8 * bench.bytes(); ++at) {
    bench.convert_same();
    const auto report = lost ? bench.read({.lost_clock = at}) : bench.read({.doubled_clock = at});
    const bool told = report.with(ChipFault::none) == 0;
    if (told) CHECK(bench.nothing_valid());
    ++(told ? count.told : bench.right() ? count.harmless : count.wrong);
    bench.convert_same();
    bench.read();
    CHECK(bench.right());  // the next frame is whole again
  }
  return count;
}

/// A frame's bytes to the chip, as "06 00 00 | 06 40 00": a bar where chip select goes up.
inline std::string sent(const FrontEnd& front_end) {
  static constexpr char digits[] = "0123456789ABCDEF";
  std::string text;
  for (const auto& segment : front_end.frame().front().segments) {
    for (std::size_t k = 0; k < segment.bytes(); ++k) {
      const unsigned value = segment.out.empty() ? 0U : std::to_integer<unsigned>(segment.out[k]);
      if (!text.empty() && text.back() != ' ') text += ' ';
      text += digits[value >> 4U];
      text += digits[value & 15U];
    }
    if (segment.release) text += " | ";
  }
  return text;
}

}  // namespace compueye::frontend::tests
