// device::ConverterSource on emulated chips: the contract of sample sources, and every fault of their wires.

#include "drivers/device/converter_source.hpp"

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <random>
#include <string>

#include "tests/drivers/device/converter_faults.hpp"
#include "tests/drivers/device/converter_rig.hpp"
#include "tests/hal/sample_source_contract.hpp"
#include "tests/memory/allocation_counter.hpp"

namespace compueye::device::tests {
namespace {

using frontend::FrontEndFault;
using frontend::FrontEndFaultKind;
using test::ms;

#if defined(COMPUEYE_SANITIZED)
constexpr unsigned seeds = 4;
#else
constexpr unsigned seeds = 16;
#endif

hal::tests::SourceUnderTest converters_under_test(const ConverterEye& eye) {
  // The contract has one source at a time, and its chips have to outlive it.
  auto chips = std::make_shared<std::unique_ptr<frontend::EmulatedFrontEnd>>();
  hal::tests::SourceUnderTest test;
  test.make = [=](hal::Clock& clock) -> std::unique_ptr<hal::SampleSource> {
    *chips = std::make_unique<frontend::EmulatedFrontEnd>(emulated(eye), clock.now_ns());
    ConverterSettings settings = source_of(**chips);
    settings.recovery_limit_ns = 0;  // the contract wants to be told at once
    return std::move(ConverterSource::create(settings, wires_of(**chips, clock), clock).value());
  };
  test.heap_calls = [] { return compueye::tests::heap_use_of_this_thread().calls(); };
  if ((*frontend::find_front_end(eye.chip)).data_ready) {
    test.lose_frames = [=](hal::SampleSource&, int frames) {
      (*chips)->inject({.kind = FrontEndFaultKind::edges_unqueued, .count = static_cast<std::uint64_t>(frames)});
    };
  }
  if (eye.tells_bits) {
    test.lose_channel = [=](hal::SampleSource&, int channel) {
      (*chips)->inject({.kind = FrontEndFaultKind::bit_error, .value = 100, .chip = channel / 8});
    };
  }
  test.disconnect = [=](hal::SampleSource&) { (*chips)->inject({.kind = FrontEndFaultKind::gone}); };
  return test;
}

/// Streams through faults, from a rig that is started, until frames come whole for ten in a row; every block is right.
void check_streams_through(ConverterRig& rig, bool codes_are_right) {
  std::optional<std::uint64_t> number;
  int whole_in_a_row = 0;
  const std::int64_t until_ns = rig.clock.now_ns() + 5 * test::second;
  const std::int64_t faults_over_ns = rig.clock.now_ns() + longest_fault_ns + 5 * rig.period_ns();
  while (rig.clock.now_ns() < until_ns && (whole_in_a_row < 10 || rig.clock.now_ns() < faults_over_ns)) {
    const auto block = rig.next(50 * ms);
    CHECK(rig.source->account().balanced());
    if (!block) {
      REQUIRE(rig.last_error.code == hal::ErrorCode::timeout);
      whole_in_a_row = 0;
      continue;
    }
    if (number) REQUIRE(block->frame > *number);
    number = block->frame;
    const bool all = std::all_of(block->valid.begin(), block->valid.end(), [](auto valid) { return valid != 0; });
    whole_in_a_row = all ? whole_in_a_row + 1 : 0;
    if (codes_are_right) REQUIRE(rig.conversion_of(*block));
  }
  CHECK(whole_in_a_row >= 10);
  CHECK_FALSE(rig.source->recovering());
}

}  // namespace

TEST_CASE("converters on SPI keep the contract of sample sources") {
  for (const ConverterEye& eye : converter_eyes) {
    CAPTURE(eye.chip);
    hal::tests::check_sample_source_contract(converters_under_test(eye));
  }
}

TEST_CASE("converters deliver what they converted, in order and on time") {
  for (const ConverterEye& eye : converter_eyes) {
    CAPTURE(eye.chip);
    ConverterRig rig(eye);
    REQUIRE(rig.source->start());
    std::optional<std::uint64_t> first;
    for (std::uint64_t k = 0; k < 300; ++k) {
      const auto block = rig.next();
      REQUIRE(block);
      REQUIRE(block->frame == k);
      const auto conversion = rig.conversion_of(*block);
      REQUIRE(conversion);
      if (!first) first = *conversion;
      REQUIRE(*conversion - *first == k);
    }
    CHECK(rig.source->account().total_dropped() == 0);
    CHECK(rig.source->faults() == 0);
  }
}

TEST_CASE("every fault of the wires is got over, and no wrong code comes of one that a chip can tell") {
  for (const ConverterEye& eye : converter_eyes) {
    for (std::size_t kind = 0; kind < frontend::front_end_fault_kind_count; ++kind) {
      const auto fault = static_cast<FrontEndFaultKind>(kind);
      if (fault == FrontEndFaultKind::other_chip) continue;  // which nobody gets over
      for (unsigned seed = 0; seed < seeds; ++seed) {
        CAPTURE(eye.chip);
        CAPTURE(std::string(frontend::name(fault)));
        CAPTURE(seed);
        ConverterRig rig(eye);
        REQUIRE(rig.source->start());
        for (int k = 0; k < 5; ++k) REQUIRE(rig.next());
        std::mt19937 random(seed);
        rig.inject(drawn(fault, rig.period_ns(), random));
        check_streams_through(rig, told_by(eye, fault));
      }
    }
  }
}

TEST_CASE("two and three faults at a time are got over") {
  for (const ConverterEye& eye : converter_eyes) {
    for (unsigned seed = 0; seed < 3 * seeds; ++seed) {
      CAPTURE(eye.chip);
      CAPTURE(seed);
      ConverterRig rig(eye);
      REQUIRE(rig.source->start());
      for (int k = 0; k < 5; ++k) REQUIRE(rig.next());
      std::mt19937 random(seed);
      for (unsigned k = 0; k < 2 + seed % 2; ++k) {
        rig.inject(drawn(any_kind(random), rig.period_ns(), random));
      }
      check_streams_through(rig, eye.tells_bits);
    }
  }
}

TEST_CASE("converters whose device files were gone stream again within a second of their return") {
  for (const ConverterEye& eye : converter_eyes) {
    for (const std::int64_t gone_ns : {5 * ms, 150 * ms, 1500 * ms, 10'000 * ms}) {
      CAPTURE(eye.chip);
      CAPTURE(gone_ns / ms);
      ConverterRig rig(eye);
      REQUIRE(rig.source->start());
      REQUIRE(rig.next());
      const std::int64_t back_ns = rig.clock.now_ns() + gone_ns;
      rig.inject({.kind = FrontEndFaultKind::gone, .duration_ns = gone_ns});
      while (rig.clock.now_ns() < back_ns) static_cast<void>(rig.next(50 * ms));
      while (rig.source->recovering()) {
        REQUIRE(rig.clock.now_ns() < back_ns + test::second);
        static_cast<void>(rig.next(50 * ms));
      }
      CHECK(rig.next());
      CHECK(rig.source->outages() == 1);
    }
  }
}

TEST_CASE("edges lost on the wire and in the kernel are counted apart, and exactly") {
  for (const ConverterEye& eye : converter_eyes) {
    if (!frontend::find_front_end(eye.chip)->data_ready) continue;
    CAPTURE(eye.chip);
    ConverterRig rig(eye);
    REQUIRE(rig.source->start());
    REQUIRE(rig.next());
    rig.inject({.kind = FrontEndFaultKind::edges_missed, .count = 7});
    const auto after_missed = rig.next();
    REQUIRE(after_missed);
    CHECK(after_missed->frame == 8);
    CHECK_FALSE(after_missed->flags.overrun);
    rig.inject({.kind = FrontEndFaultKind::edges_unqueued, .count = 9});
    const auto after_unqueued = rig.next();
    REQUIRE(after_unqueued);
    CHECK(after_unqueued->frame == 18);
    CHECK(after_unqueued->flags.overrun);
    const hal::FrameAccount account = rig.source->account();
    CHECK(account.drops(hal::DropReason::transport_gap) == 7);
    CHECK(account.drops(hal::DropReason::device_overrun) == 9);
    CHECK(account.estimated == 0);
    CHECK(rig.source->failures()[ConverterFailure::missed_edge] == 7);
    CHECK(rig.source->failures()[ConverterFailure::late_host] == 9);
  }
}

TEST_CASE("frames of a storm of edges have no time, and are lost rather than delivered with a wrong one") {
  for (const ConverterEye& eye : converter_eyes) {
    if (!frontend::find_front_end(eye.chip)->data_ready) continue;
    CAPTURE(eye.chip);
    ConverterRig rig(eye);
    REQUIRE(rig.source->start());
    std::optional<std::int64_t> first_ns;
    rig.inject({.kind = FrontEndFaultKind::edge_storm,
                .at_ns = 10 * rig.period_ns(),
                .duration_ns = 20 * rig.period_ns(),
                .value = rig.period_ns() / 50});
    while (rig.source->account().produced < 60) {
      const auto block = rig.next();
      REQUIRE(block);
      if (!first_ns) first_ns = block->t_ns;
      const std::int64_t off_ns = block->t_ns - *first_ns - static_cast<std::int64_t>(block->frame) * rig.period_ns();
      CAPTURE(block->frame);
      CHECK(std::abs(off_ns) < rig.period_ns() / 4);
    }
    CHECK(rig.source->failures()[ConverterFailure::unclear_edge] >= 15);
    CHECK(rig.source->failures()[ConverterFailure::unclear_edge] <= 22);
    CHECK(rig.source->account().drops(hal::DropReason::transport_gap) ==
          rig.source->failures()[ConverterFailure::unclear_edge]);
  }
}

TEST_CASE("chips of whose answers none is good are reset after three frames") {
  for (const ConverterEye& eye : converter_eyes) {
    CAPTURE(eye.chip);
    ConverterRig rig(eye);
    REQUIRE(rig.source->start());
    REQUIRE(rig.next());
    rig.inject({.kind = FrontEndFaultKind::miso_low, .duration_ns = 8 * rig.period_ns()});
    const auto block = rig.next();
    REQUIRE(block);
    CHECK(rig.source->failures()[ConverterFailure::stuck_low] >= 3);
    CHECK(rig.source->failures()[ConverterFailure::restart] >= 1);
    CHECK(rig.source->account().drops(hal::DropReason::corrupt) == 3);
    CHECK(rig.source->outages() == 1);
  }
}

TEST_CASE("a reader that comes late gets the newest conversion, and what it missed is counted") {
  for (const ConverterEye& eye : converter_eyes) {
    CAPTURE(eye.chip);
    ConverterRig rig(eye);
    REQUIRE(rig.source->start());
    const auto before = rig.next();
    REQUIRE(before);
    const auto first = rig.conversion_of(*before);
    REQUIRE(first);
    rig.clock.advance(10 * rig.period_ns() + rig.period_ns() / 4);
    const auto after = rig.next();
    REQUIRE(after);
    const auto second = rig.conversion_of(*after);
    REQUIRE(second);
    CHECK(after->frame == *second - *first);
    CHECK(after->flags.overrun);
    CHECK(rig.source->account().drops(hal::DropReason::device_overrun) == after->frame - 1);
  }
}

}  // namespace compueye::device::tests
