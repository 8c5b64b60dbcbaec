#include "drivers/frontend/ddc264.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <iterator>
#include <memory>
#include <optional>

#include "tests/drivers/frontend/chip_bench.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye;
using namespace compueye::frontend;
using namespace compueye::frontend::tests;

namespace {

FrontEndSettings ddc264_settings(int chips, int range = 1) {
  return {.chips = chips, .frame_rate_hz = 100.0, .range = range};
}

/// A chip whose output can be torn off, the wire then having one level.
class TornChip final : public ChipEmulator {
 public:
  void power_on() noexcept override { chip_->power_on(); }
  void reset_pin() noexcept override { chip_->reset_pin(); }
  [[nodiscard]] bool clock(bool in) noexcept override { return level.value_or(chip_->clock(in)); }
  void settings_clock(bool in) noexcept override { chip_->settings_clock(in); }
  void convert(std::span<const std::int32_t> codes) noexcept override { chip_->convert(codes); }

  std::optional<bool> level;

 private:
  std::unique_ptr<ChipEmulator> chip_ = emulate_ddc264();
};

}  // namespace

TEST_CASE("ddc264: what was converted is what is decoded, along a chain and in every range") {
  for (const int chips : {1, 3, 26}) {
    ChipBench bench(ddc264, ddc264_settings(chips, chips % 4));
    bench.configure();
    for (int f = 0; f < (chips > 3 ? 2 : 100); ++f) {
      bench.convert();
      CHECK(bench.read().with(ChipFault::none) == chips);
      CHECK(bench.right());
    }
    for (const std::int32_t level : {4096, 0xFFFFF}) {  // no light, and all that there is
      std::fill(bench.converted.begin(), bench.converted.end(), level);
      bench.convert_same();
      bench.read();
      CHECK(bench.right());
    }
  }
}

TEST_CASE("ddc264: no segment is longer than what spidev moves at once") {
  ChipBench bench(ddc264, ddc264_settings(26));
  const auto exchanges = bench.front_end->frame();
  REQUIRE(exchanges.size() == 1);
  REQUIRE(exchanges[0].segments.size() == 2);
  CHECK(exchanges[0].segments[0].bytes() == 4096);
  CHECK(exchanges[0].segments[1].bytes() == 26 * 160 + 1 - 4096);
  for (const auto& segment : exchanges[0].segments) CHECK_FALSE(segment.release);
}

TEST_CASE("ddc264: the last input comes first, most significant bit first") {
  ChipBench bench(ddc264, ddc264_settings(1));
  bench.configure();
  std::fill(bench.converted.begin(), bench.converted.end(), 0x01000);
  bench.converted[63] = 0xABCDE;
  bench.converted[62] = 0x12345;
  bench.convert_same();
  bench.read();
  const auto in = bench.front_end->frame().front().segments.front().in;
  const int bytes[] = {0xAB, 0xCD, 0xE1, 0x23, 0x45, 0x01, 0x00, 0x00, 0x10, 0x00};
  for (std::size_t k = 0; k < std::size(bytes); ++k) CHECK(std::to_integer<int>(in[k]) == bytes[k]);
  CHECK(bench.codes[63] == 0xABCDE);
}

TEST_CASE("ddc264: of slips of the clock one too few is told where the last bit is 1") {
  ChipBench bench(ddc264, ddc264_settings(1));
  bench.configure();
  bench.convert(4096);
  bench.converted[0] |= 1;
  const SlipCount odd = slips(bench, true);
  CHECK(odd.told == 1281);
  CHECK(odd.harmless == 7);
  const SlipCount doubled = slips(bench, false);
  CHECK(doubled.told == 0);
  CHECK(doubled.wrong > 1200);
  bench.converted[0] ^= 1;
  const SlipCount even = slips(bench, true);
  CHECK(even.told == 0);
  CHECK(even.wrong > 1200);
}

TEST_CASE("ddc264: of turned bits those behind the data are told") {
  ChipBench bench(ddc264, ddc264_settings(1));
  bench.configure();
  bench.convert(4096);
  for (std::size_t at = 0; at < 1288; ++at) {
    CAPTURE(at);
    bench.convert_same();
    CHECK(fault_of(bench.read({.turned_bit = at})) == (at < 1280 ? ChipFault::none : ChipFault::wrong_place));
  }
}

TEST_CASE("ddc264: a loss of power is told by the next frame, and at once where it takes 32 bytes") {
  ChipBench bench(ddc264, ddc264_settings(1));
  for (std::size_t at = 0; at <= 160; ++at) {
    CAPTURE(at);
    bench.configure();
    bench.convert(4096);
    const ChipFault first = fault_of(bench.read({.brown_out = at}));
    CHECK(first == (at == 0 ? ChipFault::stuck_low : at <= 128 ? ChipFault::lost_settings : ChipFault::none));
    CHECK(bench.right() == (at == 160));
    bench.convert(4096);
    CHECK(fault_of(bench.read()) == ChipFault::lost_settings);
    CHECK(bench.nothing_valid());
  }
  ChipBench chain(ddc264, ddc264_settings(3));
  for (std::size_t chip = 0; chip < 3; ++chip) {
    chain.configure();
    chain.chips[chip]->power_on();
    chain.convert(4096);
    CHECK(chain.read().with(ChipFault::lost_settings) == 3);
    CHECK(chain.nothing_valid());
  }
}

TEST_CASE("ddc264: wires that are stuck, at the host or within the chain, are told") {
  auto torn = std::make_unique<TornChip>();
  TornChip& last = *torn;
  Chips chips;
  chips.push_back(ddc264.emulate());
  chips.push_back(std::move(torn));
  ChipBench bench(ddc264, ddc264_settings(2), std::move(chips));
  bench.configure();
  for (const bool level : {false, true}) {
    CAPTURE(level);
    bench.convert(4096);
    CHECK(fault_of(bench.read({.stuck = level})) == (level ? ChipFault::stuck_high : ChipFault::stuck_low));
    test::check_error(bench.front_end->configure(bench.wiring, bench.clock), hal::ErrorCode::mismatch, "ddc264 chip 0",
                      {level ? "0xFFFF" : "0x0000", "0x0300", "MISO"});
    bench.bus.arm({});
    bench.configure();
    last.level = level;
    bench.convert(4096);
    const FrameReport report = bench.read();
    CHECK(report.with(level ? ChipFault::stuck_high : ChipFault::stuck_low) == 1);
    CHECK(report.with(level ? ChipFault::wrong_place : ChipFault::lost_settings) == 1);
    CHECK(bench.nothing_valid());
    test::check_error(bench.front_end->configure(bench.wiring, bench.clock), hal::ErrorCode::mismatch, "ddc264 chip 1",
                      {level ? "0xFFFF" : "0x0000", "0x0300"});
    last.level.reset();
    bench.configure();
  }
}

TEST_CASE("ddc264: a chain of another length, missing wires and frames that are too short are refused") {
  ChipBench longer(ddc264, ddc264_settings(1), emulated(ddc264, 2));
  test::check_error(longer.front_end->configure(longer.wiring, longer.clock), hal::ErrorCode::mismatch, "ddc264 chip 1",
                    {"1", "DIN"});
  Chips one = emulated(ddc264, 1);
  ChipBench shorter(ddc264, ddc264_settings(2), std::move(one));
  test::check_error(shorter.front_end->configure(shorter.wiring, shorter.clock), hal::ErrorCode::mismatch,
                    "ddc264 chip 1", {"0x0000", "0x0300"});
  longer.wiring.settings = nullptr;
  test::check_error(longer.front_end->configure(longer.wiring, longer.clock), hal::ErrorCode::usage, "ddc264",
                    {"DIN_CFG", "RESET"});
  test::check_error(ddc264.make({.chips = 1, .frame_rate_hz = 6251.0}), hal::ErrorCode::out_of_range, "ddc264",
                    {"6251", "6250"});
}
