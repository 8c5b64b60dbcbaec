#include "drivers/frontend/ads131m08.hpp"

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "drivers/frontend/chip_emulator.hpp"
#include "tests/drivers/frontend/chip_bench.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye;
using namespace compueye::frontend;
using namespace compueye::frontend::tests;

namespace {

FrontEndSettings ads131m08_settings(int chips, double rate = 4000.0, int range = 0) {
  return {.chips = chips, .frame_rate_hz = rate, .range = range};
}

/// Keeps the bytes that go out of it in its first segments.
std::vector<std::string> sent_by_configure(ChipBench& bench) {
  struct Recorder final : hal::SpiBus {
    explicit Recorder(hal::SpiBus& to) : bus(to) {}
    [[nodiscard]] const hal::SpiDescription& describe() const noexcept override { return bus.describe(); }
    [[nodiscard]] hal::Result<void> open(const hal::SpiMode& mode) override { return bus.open(mode); }
    void close() noexcept override {}
    [[nodiscard]] hal::Result<void> exchange(std::span<const hal::SpiSegment> segments) override {
      std::string text;
      for (std::size_t k = 0; k < 6; ++k) {
        const auto value = std::to_integer<unsigned>(segments.front().out[k]);
        text += "0123456789ABCDEF"[value >> 4U];
        text += "0123456789ABCDEF"[value & 15U];
      }
      all.push_back(text);
      CHECK(segments.front().bytes() == 30);
      return bus.exchange(segments);
    }
    hal::SpiBus& bus;
    std::vector<std::string> all;
  } recorder(bench.bus);
  bench.wiring.data = &recorder;
  CHECK(bench.front_end->configure(bench.wiring, bench.clock).has_value());
  bench.wiring.data = &bench.bus;
  return recorder.all;
}

}  // namespace

TEST_CASE("ads131m08: what was converted is what is decoded, at every rate and in every range") {
  for (int k = 0; k < 8; ++k) {
    const double rate = k == 7 ? 251.9685 : 32000.0 / (1 << k);
    ChipBench bench(ads131m08, ads131m08_settings(2, rate, k));
    bench.configure();
    for (int f = 0; f < 100; ++f) {
      bench.convert();
      CHECK(bench.read().with(ChipFault::none) == 2);
      CHECK(bench.right());
    }
    for (const std::int32_t level : {0, 0x800000, 0xFFFFFF}) {
      bench.converted.assign(16, level);
      bench.convert_same();
      bench.read();
      CHECK(bench.right());
    }
  }
}

TEST_CASE("ads131m08: commands and frames are the datasheet's") {
  ChipBench bench(ads131m08, ads131m08_settings(1, 4000.0, 2));
  // RESET, NULL, RREG of 00h; then WREG, RREG and NULL of 03h, 04h, 05h and 02h. OSR 1024 is 011.
  const std::vector<std::string> expected{"001100000000", "000000000000", "A00000000000", "000000000000",
                                          "618000FF0E00", "A18000000000", "000000000000", "620000222200",
                                          "A20000000000", "000000000000", "628000222200", "A28000000000",
                                          "000000000000", "610000011000", "A10000000000", "000000000000"};
  CHECK(sent_by_configure(bench) == expected);
  bench.converted.assign(8, 0x800000);
  bench.converted[1] = 0x7FFFFF;
  bench.converted[7] = 0xFFFFFF;
  bench.convert_same();
  bench.read();
  const auto in = bench.front_end->frame().front().segments[0].in;
  REQUIRE(in.size() == 30);
  const auto word = [&](std::size_t k) {
    return std::to_integer<unsigned>(in[3 * k]) << 16U | std::to_integer<unsigned>(in[3 * k + 1]) << 8U |
           std::to_integer<unsigned>(in[3 * k + 2]);
  };
  CHECK(word(0) == 0x01FF00);  // WLENGTH 01, all channels ready
  CHECK(word(1) == 0x000000);
  CHECK(word(2) == 0xFFFFFF);
  CHECK(word(8) == 0x7FFFFF);
  CHECK((word(9) & 0xFFU) == 0);
}

TEST_CASE("ads131m08: no turned bit is delivered") {
  ChipBench bench(ads131m08, ads131m08_settings(1));
  bench.configure();
  for (std::size_t at = 0; at < 240; ++at) {
    CAPTURE(at);
    bench.convert();
    CHECK(fault_of(bench.read({.turned_bit = at})) == ChipFault::crc_error);
    CHECK(bench.nothing_valid());
  }
}

TEST_CASE("ads131m08: no lost or doubled clock gives a wrong code") {
  ChipBench bench(ads131m08, ads131m08_settings(1));
  bench.configure();
  bench.convert();
  bench.converted[0] |= 1;
  // Only the eight zeros behind the CRC may move: told is every clock up to the CRC's last 1.
  for (const bool lost : {true, false}) {
    const SlipCount count = slips(bench, lost);
    CHECK(count.wrong == 0);
    CHECK(count.told + count.harmless == 240);
    CHECK(count.told >= 216);
    CHECK(count.told <= 233);
  }
}

TEST_CASE("ads131m08: a loss of power is told at once, behind the CRC by the next frame") {
  ChipBench bench(ads131m08, ads131m08_settings(1));
  for (std::size_t at = 0; at < 30; ++at) {
    CAPTURE(at);
    bench.configure();
    bench.convert();
    const ChipFault first = fault_of(bench.read({.brown_out = at}));
    CHECK(first == (at == 0 ? ChipFault::stuck_low : at < 29 ? ChipFault::crc_error : ChipFault::none));
    if (at == 29) CHECK(bench.right());
    bench.convert();
    CHECK(fault_of(bench.read()) == ChipFault::lost_settings);  // FF28h
    bench.convert();
    CHECK(fault_of(bench.read()) == ChipFault::lost_settings);  // STATUS.RESET, until it is configured
    CHECK(bench.nothing_valid());
  }
}

TEST_CASE("ads131m08: a frame without a conversion is told") {
  ChipBench bench(ads131m08, ads131m08_settings(2));
  bench.configure();
  bench.convert();
  bench.read();
  CHECK(bench.right());
  CHECK(fault_of(bench.read()) == ChipFault::no_new_sample);
  CHECK(bench.nothing_valid());
}

TEST_CASE("ads131m08: a line that is stuck, another chip or none is told") {
  ChipBench bench(ads131m08, ads131m08_settings(2));
  bench.configure();
  bench.convert();
  CHECK(fault_of(bench.read({.stuck = false})) == ChipFault::stuck_low);
  CHECK(fault_of(bench.read({.stuck = true})) == ChipFault::stuck_high);
  CHECK(bench.nothing_valid());
  for (const bool level : {false, true}) {
    bench.bus.arm({.stuck = level});
    test::check_error(bench.front_end->configure(bench.wiring, bench.clock), hal::ErrorCode::mismatch,
                      "ads131m08 chip 0", {"RESET", level ? "0xFFFF" : "0x0000", "0xFF28", "MISO"});
  }
  Chips mixed;
  mixed.push_back(ads131m08.emulate());
  mixed.push_back(emulate_ads131m08(0x2600));
  ChipBench other(ads131m08, ads131m08_settings(2), std::move(mixed));
  test::check_error(other.front_end->configure(other.wiring, other.clock), hal::ErrorCode::mismatch, "ads131m08 chip 1",
                    {"ID", "0x2600", "0x2800"});
}

TEST_CASE("ads131m08: a rate that is not its own is refused with the nearest") {
  test::check_error(ads131m08.make(ads131m08_settings(1, 3900.0)), hal::ErrorCode::out_of_range, "ads131m08",
                    {"3900", "4000"});
  test::check_error(ads131m08.make(ads131m08_settings(1, 40000.0)), hal::ErrorCode::out_of_range, "ads131m08",
                    {"40000", "32000"});
}
