#include "drivers/frontend/ads8688.hpp"

#include <doctest/doctest.h>

#include <string>

#include "tests/drivers/frontend/chip_bench.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye;
using namespace compueye::frontend;
using namespace compueye::frontend::tests;

namespace {

FrontEndSettings ads8688_settings(int chips, int range) {
  return {.chips = chips, .frame_rate_hz = 100.0, .range = range};
}

}  // namespace

TEST_CASE("ads8688: what was converted is what is decoded, of several chips and in every range") {
  for (int range = 0; range < static_cast<int>(ads8688.ranges.size()); ++range) {
    CAPTURE(range);
    ChipBench bench(ads8688, ads8688_settings(3, range));
    bench.configure();
    for (int f = 0; f < 100; ++f) {
      bench.convert();
      CHECK(bench.read().with(ChipFault::none) == 3);
      CHECK(bench.right());
    }
    for (const std::int32_t level : {0, 0xFFFF}) {
      bench.converted.assign(24, level);
      bench.convert_same();
      bench.read();
      CHECK(bench.right());
    }
  }
}

TEST_CASE("ads8688: frames are the datasheet's: AUTO_RST, then results with their tail") {
  ChipBench bench(ads8688, ads8688_settings(1, 3));
  std::string expected = "A0 00 | ";
  for (int k = 0; k < 8; ++k) expected += "00 00 00 00 00 00 | ";
  CHECK(sent(*bench.front_end) == expected);
  bench.configure();
  bench.converted.assign(8, 0x1234);
  bench.converted[6] = 0xA55A;
  bench.convert_same();
  bench.read();
  // Channel 6, device 1, range 5 (0..10.24 V): 0110 01 101 0000000.
  const auto in = bench.front_end->frame().front().segments[7].in;
  const int bytes[] = {0x00, 0x00, 0xA5, 0x5A, 0x66, 0x80};
  for (std::size_t k = 0; k < 6; ++k) CHECK(std::to_integer<int>(in[k]) == bytes[k]);
}

TEST_CASE("ads8688: no lost or doubled clock gives a wrong code") {
  for (int range = 0; range < static_cast<int>(ads8688.ranges.size()); ++range) {
    CAPTURE(range);
    ChipBench bench(ads8688, ads8688_settings(1, range));
    bench.configure();
    bench.convert();
    bench.read();
    // Without one of its 16 clocks AUTO_RST is aborted, and the sequence goes on by itself; with one more it may be
    // D000h, which is one channel for all. Of the 48 of a result, told are those up to the last 1 of its tail, and the
    // one that would hold it.
    const int last_one[] = {37, 40, 39, 40, 39};
    const SlipCount lost = slips(bench, true);
    CHECK(lost.wrong == 0);
    CHECK(lost.told == 8 * (last_one[range] + 2));
    const SlipCount doubled = slips(bench, false);
    CHECK(doubled.wrong == 0);
    CHECK(doubled.told == 1 + 8 * last_one[range]);
  }
}

TEST_CASE("ads8688: a loss of power is told at once, or where only zeros were left by the next frame") {
  for (const int range : {0, 3}) {
    ChipBench bench(ads8688, ads8688_settings(1, range));
    for (std::size_t at = 0; at < 50; ++at) {
      CAPTURE(at);
      bench.configure();
      bench.convert();
      const ChipFault first = fault_of(bench.read({.brown_out = at}));
      if (at < 5) {
        CHECK(first == ChipFault::stuck_low);  // idle for all that says anything
      } else if (at == 49 && range == 0) {
        CHECK(first == ChipFault::none);  // only zeros were left to send
        CHECK(bench.right());
      } else {
        CHECK(first == ChipFault::lost_settings);
      }
      bench.convert();
      CHECK(fault_of(bench.read()) == ChipFault::lost_settings);
      CHECK(bench.nothing_valid());
    }
  }
}

TEST_CASE("ads8688: bits of the tail that are turned are told by what they are") {
  ChipBench bench(ads8688, ads8688_settings(1, 3));
  bench.configure();
  for (std::size_t at = 0; at < 8 * 50; ++at) {
    CAPTURE(at);
    bench.convert();
    const ChipFault fault = fault_of(bench.read({.turned_bit = at}));
    const std::size_t clock = at < 16 ? 0 : (at - 16) % 48;
    const bool place = (clock >= 32 && clock < 36) || clock >= 41;
    const bool settings = clock >= 36 && clock < 41;
    CHECK(fault == (place ? ChipFault::wrong_place : settings ? ChipFault::lost_settings : ChipFault::none));
  }
}

TEST_CASE("ads8688: a line that is stuck, or no chip, is told") {
  ChipBench bench(ads8688, ads8688_settings(2, 3));
  bench.configure();
  bench.convert();
  CHECK(fault_of(bench.read({.stuck = false})) == ChipFault::stuck_low);
  CHECK(bench.nothing_valid());
  CHECK(fault_of(bench.read({.stuck = true})) == ChipFault::stuck_high);
  CHECK(bench.nothing_valid());
  bench.bus.arm({.stuck = false});
  test::check_error(bench.front_end->configure(bench.wiring, bench.clock), hal::ErrorCode::mismatch, "ads8688 chip 0",
                    {"AUTO_SEQ_EN", "0x00", "0xFF", "MISO"});
  Chips one;
  one.push_back(ads8688.emulate());
  ChipBench missing(ads8688, ads8688_settings(2, 3), std::move(one));
  test::check_error(missing.front_end->configure(missing.wiring, missing.clock), hal::ErrorCode::mismatch,
                    "ads8688 chip 1", {"0xFF", "0x00"});
  bench.bus.arm({});
  bench.wiring.select = nullptr;
  test::check_error(bench.front_end->configure(bench.wiring, bench.clock), hal::ErrorCode::usage, "ads8688 chip 1",
                    {"0"});
}
