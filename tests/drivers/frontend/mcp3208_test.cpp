#include "drivers/frontend/mcp3208.hpp"

#include <doctest/doctest.h>

#include "tests/drivers/frontend/chip_bench.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye;
using namespace compueye::frontend;
using namespace compueye::frontend::tests;

namespace {

const FrontEndSettings two_mcp3208{.chips = 2, .frame_rate_hz = 100.0};
const FrontEndSettings one_mcp3208{.frame_rate_hz = 100.0};

}  // namespace

TEST_CASE("mcp3208: what was converted is what is decoded, of several chips") {
  ChipBench bench(mcp3208, two_mcp3208);
  bench.configure();
  for (int f = 0; f < 100; ++f) {
    bench.convert();
    CHECK(bench.read().with(ChipFault::none) == 2);
    CHECK(bench.right());
  }
  bench.converted.assign(16, 0xFFF);  // saturated inputs are data
  bench.convert_same();
  bench.read();
  CHECK(bench.right());
  bench.converted.assign(16, 0);
  bench.convert_same();
  bench.read();
  CHECK(bench.right());
}

TEST_CASE("mcp3208: frames are the datasheet's figure 6-1") {
  ChipBench bench(mcp3208, one_mcp3208);
  CHECK(sent(*bench.front_end) ==
        "06 00 00 | 06 40 00 | 06 80 00 | 06 C0 00 | 07 00 00 | 07 40 00 | 07 80 00 | 07 C0 00 | ");
  const auto segment = bench.front_end->frame().front().segments[5];
  bench.converted.assign(8, 0xA5C);
  bench.convert_same();
  bench.read();
  // Eleven clocks of the pull-up, the null bit, and 1010 0101 1100.
  CHECK(std::to_integer<int>(segment.in[0]) == 0xFF);
  CHECK(std::to_integer<int>(segment.in[1]) == 0xEA);
  CHECK(std::to_integer<int>(segment.in[2]) == 0x5C);
}

TEST_CASE("mcp3208: of a lost or doubled clock those between start and null bit are told") {
  ChipBench bench(mcp3208, one_mcp3208);
  bench.configure();
  bench.converted = {0x5A5, 0xA5A, 0x333, 0xCCC, 0x123, 0xEDC, 0x696, 0x969};
  // Of the 24 clocks of each of eight conversions: five zeros come before the start bit, which chips wait for.
  const SlipCount lost = slips(bench, true);
  CHECK(lost.told == 8 * 7);
  CHECK(lost.harmless >= 8 * 5);
  CHECK(lost.harmless + lost.wrong == 8 * (24 - 7));
  CHECK(lost.wrong > 8 * 8);
  const SlipCount doubled = slips(bench, false);
  const int high = 4;  // of the codes have B11, which a doubled clock before the null bit puts in its place
  CHECK(doubled.told == 8 * 5 + high);
  CHECK(doubled.harmless >= 8 * 5);
  CHECK(doubled.harmless + doubled.wrong == 8 * (24 - 5) - high);
  CHECK(doubled.wrong > 8 * 8);
}

TEST_CASE("mcp3208: a loss of power is told but in the last byte of a conversion") {
  ChipBench bench(mcp3208, one_mcp3208);
  bench.configure();
  for (std::size_t at = 0; at < 24; ++at) {
    CAPTURE(at);
    bench.convert();
    const auto fault = fault_of(bench.read({.brown_out = at}));
    CHECK(fault == (at % 3 == 2 ? ChipFault::none : ChipFault::wrong_place));
    bench.convert();
    bench.read();
    CHECK(bench.right());
  }
}

TEST_CASE("mcp3208: a line that is stuck, or no chip, is told") {
  ChipBench bench(mcp3208, two_mcp3208);
  bench.configure();
  bench.convert();
  CHECK(fault_of(bench.read({.stuck = false})) == ChipFault::stuck_low);
  CHECK(bench.nothing_valid());
  CHECK(fault_of(bench.read({.stuck = true})) == ChipFault::stuck_high);
  CHECK(bench.nothing_valid());
  bench.bus.arm({.stuck = false});
  test::check_error(bench.front_end->configure(bench.wiring, bench.clock), hal::ErrorCode::mismatch, "mcp3208 chip 0",
                    {"0x000", "0xFFE", "MISO"});
  bench.bus.arm({.stuck = true});
  test::check_error(bench.front_end->configure(bench.wiring, bench.clock), hal::ErrorCode::mismatch, "mcp3208 chip 0",
                    {"0xFFF", "0xFFE", "MISO"});

  Chips one;
  one.push_back(mcp3208.emulate());
  ChipBench missing(mcp3208, two_mcp3208, std::move(one));
  test::check_error(missing.front_end->configure(missing.wiring, missing.clock), hal::ErrorCode::mismatch,
                    "mcp3208 chip 1", {"0xFFF"});
}
