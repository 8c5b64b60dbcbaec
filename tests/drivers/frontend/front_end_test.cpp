#include "drivers/frontend/front_end.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <set>
#include <string>
#include <string_view>

#include "tests/drivers/frontend/chip_bench.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/memory/allocation_counter.hpp"

using namespace compueye;
using namespace compueye::frontend;
using namespace compueye::frontend::tests;

namespace {

/// Slow enough for every chip, and one of those with rates of their own.
FrontEndSettings of_every_chip(int chips) {
  return {.chips = chips, .frame_rate_hz = 1000.0};
}

}  // namespace

TEST_CASE("every front end has a name, is found by it, and makes what its row says") {
  std::set<std::string_view> seen;
  for (const FrontEndRow* row : front_ends()) {
    CAPTURE(row->name);
    CHECK(seen.insert(row->name).second);
    CHECK(find_front_end(row->name) == row);
    const auto made = row->make(of_every_chip(2));
    REQUIRE(made.has_value());
    CHECK((*made)->channels() == 2 * row->channels);
    CHECK((*made)->frame().size() == (row->chain ? 1 : 2));
  }
  CHECK(seen == std::set<std::string_view>{"ads131m08", "ads8688", "ddc264", "mcp3208"});
  CHECK(find_front_end("mcp320") == nullptr);
}

TEST_CASE("settings that a chip cannot have are refused with what it takes") {
  for (const FrontEndRow* row : front_ends()) {
    const std::string name(row->name);
    CAPTURE(name);
    const auto refused = [&](FrontEndSettings settings, const test::Named& named) {
      test::check_error(row->make(settings), hal::ErrorCode::out_of_range, name, named);
    };
    for (const int chips : {0, -1, 1025, std::numeric_limits<int>::max()}) {
      refused(of_every_chip(chips), {std::to_string(chips), "1024"});
    }
    const int ranges = std::max(1, static_cast<int>(row->ranges.size()));
    for (const int range : {-1, ranges}) {
      refused({.chips = 1, .frame_rate_hz = 1000.0, .range = range},
              {std::to_string(range), std::to_string(ranges - 1)});
    }
    refused({.chips = 1, .clock_hz = row->spi.clock_hz + 1, .frame_rate_hz = 1000.0},
            {std::to_string(row->spi.clock_hz + 1), std::to_string(row->spi.clock_hz)});
    for (const double rate : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), 1e9}) {
      refused({.chips = 1, .frame_rate_hz = rate}, {"frame_rate_hz"});
    }
    // What a slow clock cannot move.
    refused({.chips = 10, .clock_hz = 100'000, .frame_rate_hz = 1000.0}, {"1000", "10"});
  }
}

TEST_CASE("decoding does not use the heap, whatever came") {
  for (const FrontEndRow* row : front_ends()) {
    CAPTURE(row->name);
    ChipBench bench(*row, of_every_chip(2));
    bench.configure();
    bench.convert(4096 >> (20 - std::min(20, row->bits)));
    const BusFaults faults[] = {{}, {.lost_clock = 9}, {.stuck = false}, {.stuck = true}};
    for (const BusFaults& fault : faults) {
      bench.read(fault);
      const auto before = compueye::tests::heap_use_of_this_thread();
      const FrameReport report = bench.front_end->decode(bench.codes, bench.valid);
      CHECK((compueye::tests::heap_use_of_this_thread() - before).calls() == 0);
      int chips = 0;
      for (const auto count : report.chips) chips += count;
      CHECK(chips == 2);
    }
  }
}
