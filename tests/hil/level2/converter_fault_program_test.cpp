// Faults of converters through the real spidev ABI and libgpiod, as `run` has them: what a controller refuses, what it
// loses, and what is wrong on the wire.

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/eye/board.hpp"
#include "firmware/eye/source_list.hpp"
#include "tests/hil/level2/benches.hpp"
#include "tests/hil/level2/wired_board.hpp"

namespace compueye::hil {

using device::tests::ConverterEye;
using frontend::FrontEndFaultKind;

namespace {

struct WireFault {
  FrontEndFaultKind kind;
  std::int64_t duration_ns;
  std::uint64_t count;
  std::vector<std::string_view> counters;  ///< of which one at least has moved
};

std::uint64_t moved(const hal::SampleSource& source, const std::vector<std::string_view>& names) {
  std::uint64_t sum = 0;
  for (const hal::Counter& each : source.counters()) {
    if (std::find(names.begin(), names.end(), each.name) != names.end()) sum += each.count;
  }
  return sum;
}

/// Whether every channel shows one and the same conversion.
bool right(const hal::SampleBlock& block) {
  for (std::uint64_t index = 0; index < 20'000; ++index) {
    bool same = true;
    for (std::size_t c = 0; same && c < block.codes.size(); ++c) {
      same = block.codes[c] == device::tests::shown_code(index, c, block.bits);
    }
    if (same) return true;
  }
  return false;
}

/// Reads until so many whole frames came in a row, and returns the last of them judged. A busy machine takes its time.
bool reads_whole(hal::SampleSource& source, int frames) {
  hal::MonotonicClock clock;
  std::optional<std::uint64_t> number;
  for (int whole_in_a_row = 0;;) {
    const auto block = source.read(clock.now_ns() + patience_ns);
    REQUIRE_MESSAGE(block.has_value(), block.error().text());
    if (number) REQUIRE(block->frame > *number);
    number = block->frame;
    REQUIRE(source.account().balanced());
    whole_in_a_row = whole(*block) ? whole_in_a_row + 1 : 0;
    if (whole_in_a_row == frames) return right(*block);
  }
}

}  // namespace

TEST_CASE("program: transfers that fail before or after they are carried out, and a stuck data line, are got over") {
  const std::vector<WireFault> faults{
      {FrontEndFaultKind::bus_error, 0, 2, {"bus_error"}},
      {FrontEndFaultKind::answer_lost, 0, 2, {"bus_error"}},
      {FrontEndFaultKind::miso_low, 300'000'000, 1, {"stuck_low", "crc_error", "wrong_place", "lost_settings"}},
      {FrontEndFaultKind::miso_high, 300'000'000, 1, {"stuck_high", "crc_error", "wrong_place", "lost_settings"}},
  };
  HIL_TESTBED(testbed);
  for (const ConverterEye& each : device::tests::converter_eyes) {
    const ConverterEye eye = slow(each);
    CAPTURE(eye.chip);
    ConverterPort port(testbed, device::tests::emulated(eye));
    const auto board = firmware::parse_board(board_text(eye, port), "board.toml");
    REQUIRE_MESSAGE(board.has_value(), board.error().text());
    const auto made = firmware::real_eye(*board);
    REQUIRE_MESSAGE(made.has_value(), made.error().text());
    hal::SampleSource& source = *made->source;
    REQUIRE(source.start());
    CHECK(reads_whole(source, 3));
    for (const WireFault& fault : faults) {
      CAPTURE(std::string(frontend::name(fault.kind)));
      const std::uint64_t before = moved(source, fault.counters);
      port.inject({.kind = fault.kind, .duration_ns = fault.duration_ns, .count = fault.count});
      hal::MonotonicClock clock;
      const std::int64_t until_ns = clock.now_ns() + patience_ns;
      while (moved(source, fault.counters) == before && clock.now_ns() < until_ns) {
        static_cast<void>(source.read(clock.now_ns() + 100'000'000));
      }
      CHECK(moved(source, fault.counters) > before);
      CHECK(reads_whole(source, 5));
      CHECK_FALSE(source.recovering());
    }
    source.stop();
    CHECK(source.account().balanced());
    CHECK(moved(source, {"hang"}) == 0);
  }
}

TEST_CASE("program: converters of another kind are refused with what they are") {
  HIL_TESTBED(testbed);
  const auto kinds = frontend::front_ends();
  for (const ConverterEye& each : device::tests::converter_eyes) {
    const ConverterEye eye = slow(each);
    CAPTURE(eye.chip);
    std::size_t other = 0;
    while (kinds[other]->name == eye.chip) ++other;
    ConverterPort port(testbed, device::tests::emulated(eye));
    port.inject({.kind = FrontEndFaultKind::other_chip, .value = static_cast<std::int64_t>(other)});
    const auto board = firmware::parse_board(board_text(eye, port), "board.toml");
    REQUIRE_MESSAGE(board.has_value(), board.error().text());
    const auto made = firmware::real_eye(*board);
    REQUIRE_FALSE(made.has_value());
    CHECK_MESSAGE(made.error().code == hal::ErrorCode::mismatch, made.error().text());
    CHECK_FALSE(made.error().sentence.empty());
  }
}

}  // namespace compueye::hil
