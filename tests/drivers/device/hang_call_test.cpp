// device::HangProofSource over a source whose every call may not come back.

#include <doctest/doctest.h>
#include <sched.h>

#include <atomic>
#include <memory>
#include <string>

#include "drivers/device/hang_proof_source.hpp"
#include "tests/drivers/device/hang_gate.hpp"
#include "tests/drivers/device/hanging_source.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/hal/no_threads.hpp"
#include "tests/hal/reference_source.hpp"
#include "tests/hal/sample_source_contract.hpp"
#include "tests/hal/units.hpp"
#include "tests/memory/allocation_counter.hpp"
#include "tests/source_folder.hpp"

namespace compueye::device::tests {
namespace {

using hal::ErrorCode;
using test::ms;
using test::second;

constexpr int one = 1;

struct Rig {
  [[nodiscard]] hal::Result<std::unique_ptr<HangProofSource>> make(std::size_t ahead = 0) {
    return HangProofSource::create(
        "the eye",
        [gate = gate](hal::Clock& by) -> hal::Result<HangProofSource::Source> {
          gate->pass("open");
          return std::make_unique<HangingSource>(by, gate);
        },
        time_of(clock, gate), ahead);
  }
  [[nodiscard]] std::int64_t now_ns() const { return clock->now_ns(); }
  /// A read of 100 ms, which takes no longer.
  [[nodiscard]] hal::Result<hal::SampleBlock> read(HangProofSource& source) const {
    const std::int64_t deadline_ns = now_ns() + 100 * ms;
    auto block = source.read(deadline_ns);
    CHECK(now_ns() <= deadline_ns + latest_answer_ns);
    CHECK(source.account().balanced());
    return block;
  }

  std::shared_ptr<hal::VirtualClock> clock = std::make_shared<hal::VirtualClock>(second);
  std::shared_ptr<HangGate> gate = std::make_shared<HangGate>();
};

void check_hangs(const hal::Error& error, ErrorCode code, std::string_view place, std::string_view call) {
  CHECK(error.code == code);
  CHECK(error.place == place);
  CHECK_MESSAGE(error.sentence.find("from '" + std::string(call) + "' for ") != std::string::npos, error.sentence);
}

TEST_CASE("hang: a source behind a thread of its own keeps the contract of sources") {
  // The contract has one source and one clock at a time.
  hal::tests::SourceUnderTest test;
  const auto gate = std::make_shared<HangGate>();
  const auto at = std::make_shared<std::atomic<HangingSource*>>();
  test.make = [=](hal::Clock& clock) -> std::unique_ptr<hal::SampleSource> {
    const auto open = [gate, at](hal::Clock& by) -> hal::Result<HangProofSource::Source> {
      auto made = std::make_unique<HangingSource>(by, gate);
      *at = made.get();
      return made;
    };
    const std::shared_ptr<hal::Clock> lent(std::shared_ptr<void>(), &clock);
    return std::move(HangProofSource::create("the eye", open, time_of(lent, gate), 0).value());
  };
  test.heap_calls = [] { return compueye::tests::heap_use_of_this_thread().calls(); };
  test.lose_frames = [=](hal::SampleSource&, int frames) { at->load()->lose_frames(frames); };
  test.lose_channel = [=](hal::SampleSource&, int channel) { at->load()->lose_channel(channel); };
  test.disconnect = [=](hal::SampleSource&) { at->load()->disconnect(); };
  hal::tests::check_sample_source_contract(test);
}

TEST_CASE("hang: and one that reads ahead does, but that its frames may come before their reader's time") {
  hal::tests::SourceUnderTest test;
  const auto gate = std::make_shared<HangGate>();
  test.make = [=](hal::Clock& clock) -> std::unique_ptr<hal::SampleSource> {
    const auto open = [gate](hal::Clock& by) -> hal::Result<HangProofSource::Source> {
      return std::make_unique<HangingSource>(by, gate);
    };
    const std::shared_ptr<hal::Clock> lent(std::shared_ptr<void>(), &clock);
    return std::move(HangProofSource::create("the eye", open, time_of(lent, gate)).value());
  };
  // Time that the device's thread moves on.
  test.make_clock = [] { return std::make_unique<hal::VirtualClock>(); };
  test.paced = false;
  test.heap_calls = [] { return compueye::tests::heap_use_of_this_thread().calls(); };
  hal::tests::check_sample_source_contract(test);
}

TEST_CASE("hang: a reader who comes late finds the frames that were read ahead, and no more of them") {
  constexpr std::size_t ahead = 4;
  Rig rig;
  const auto source = rig.make(ahead).value();
  REQUIRE(source->start());
  REQUIRE(rig.read(*source));
  // In its hand is one; so many more fit, and then the device is not read any more.
  rig.gate->wait_for("answer", 1 + ahead);
  for (std::uint64_t k = 1; k <= ahead; ++k) {
    const auto block = rig.read(*source);
    REQUIRE(block);
    CHECK(block->frame == k);
    CHECK(block->codes[1] == static_cast<std::int32_t>(3 * k + 1));
    CHECK(source->account().delivered == k + 1);
  }
  source->stop();
  const hal::FrameAccount account = source->account();
  CHECK(account.delivered == 1 + ahead);
  CHECK(account.drops(hal::DropReason::stopped) == account.total_dropped());
  CHECK(account.balanced());
}

TEST_CASE("hang: a device that cannot be opened is given up in its time, and closed when it is there after all") {
  Rig rig;
  rig.gate->hang_at("open");
  const std::int64_t begun_ns = rig.now_ns();
  const auto made = rig.make();
  REQUIRE_FALSE(made);
  check_hangs(made.error(), ErrorCode::timeout, "the eye", "open");
  CHECK(made.error().sentence.find("10.0 s") != std::string::npos);
  CHECK(rig.now_ns() - begun_ns == limit_of(DeviceCall::open).budget_ns + limit_of(DeviceCall::close).budget_ns);
  rig.gate->release();
  rig.gate->wait_for("closed", one);
  CHECK(rig.gate->passed("start") == 0);
}

TEST_CASE("hang: a start that does not come back is an error, and the next one works once it has") {
  Rig rig;
  const auto source = rig.make().value();
  rig.gate->hang_at("start");
  const std::int64_t begun_ns = rig.now_ns();
  const auto started = source->start();
  REQUIRE_FALSE(started);
  check_hangs(started.error(), ErrorCode::timeout, "reference-1", "start");
  CHECK(rig.now_ns() - begun_ns == limit_of(DeviceCall::start).budget_ns);
  CHECK_FALSE(source->started());
  CHECK_FALSE(source->start());  // it still hangs
  rig.gate->release();
  REQUIRE(source->start());
  CHECK(rig.gate->passed("stop") == 1);  // the start that nobody waited for
  const auto block = rig.read(*source);
  REQUIRE(block);
  CHECK(block->frame == 0);
  CHECK_FALSE(source->hang());
  CHECK(source->faults() == 0);
}

TEST_CASE("hang: a read that does not come back times out on time, and what it brings late is not lost") {
  Rig rig;
  const auto source = rig.make().value();
  REQUIRE(source->start());
  for (std::uint64_t k = 0; k < 5; ++k) REQUIRE(rig.read(*source).value().frame == k);
  rig.gate->hang_at("read");
  const std::int64_t begun_ns = rig.now_ns();
  for (int k = 0; k < 30; ++k) {
    const auto block = rig.read(*source);
    REQUIRE_FALSE(block);
    CHECK(block.error().code == ErrorCode::timeout);
    CHECK(block.error().sentence.empty());
    CHECK(source->recovering() == (rig.now_ns() - begun_ns - 100 * ms >= limit_of(DeviceCall::read).budget_ns));
  }
  CHECK(source->faults() == 1);  // one hang, however often it was waited for
  CHECK(source->account().delivered == 5);
  rig.gate->release();
  std::uint64_t next = 5, overruns = 0;
  for (int k = 0; k < 20; ++k) {
    const auto block = rig.read(*source);
    REQUIRE(block);
    overruns += block->frame - next;
    next = block->frame + 1;
    CHECK_FALSE(source->recovering());
  }
  CHECK(overruns > 3000);  // of 1 ms each
  CHECK(source->account().drops(hal::DropReason::device_overrun) == overruns);
  CHECK(source->account().delivered == 25);
  CHECK(source->account().produced == next);
  source->stop();
  CHECK(source->counters().back().name == "hang");
  CHECK(source->counters().back().count == 1);
}

TEST_CASE("hang: a read that hangs for too long ends the stream with the call's name, and stop leaves it") {
  Rig rig;
  const auto source = rig.make().value();
  REQUIRE(source->start());
  REQUIRE(rig.read(*source));
  rig.gate->hang_at("read");
  const std::int64_t begun_ns = rig.now_ns();
  auto block = rig.read(*source);
  for (int k = 0; k < 200 && !block && block.error().code == ErrorCode::timeout; ++k) block = rig.read(*source);
  REQUIRE_FALSE(block);
  check_hangs(block.error(), ErrorCode::disconnected, "reference-1", "read");
  CHECK_FALSE(source->recovering());
  const std::int64_t took_ns = rig.now_ns() - begun_ns;
  CHECK(took_ns >= hang_given_up_after_ns);
  CHECK(took_ns <= hang_given_up_after_ns + 250 * ms);
  CHECK(source->read(rig.now_ns() + ms).error().code == ErrorCode::disconnected);

  const std::int64_t stopped_ns = rig.now_ns();
  source->stop();
  CHECK(rig.now_ns() - stopped_ns == limit_of(DeviceCall::stop).budget_ns);
  REQUIRE(source->hang());
  check_hangs(*source->hang(), ErrorCode::timeout, "reference-1", "read");
  CHECK(source->account().delivered == 1);
  CHECK(source->account().balanced());
  CHECK(source->counters().back().count == 1);
  CHECK_FALSE(source->start());
  rig.gate->release();
  REQUIRE(source->start());
  REQUIRE(rig.read(*source).value().frame == 0);
}

TEST_CASE("hang: a frame that came late is the answer of the next read, by its own number and time") {
  Rig rig;
  const auto source = rig.make().value();
  REQUIRE(source->start());
  REQUIRE(rig.read(*source));
  rig.gate->hang_at("answer");
  REQUIRE_FALSE(rig.read(*source));
  CHECK(source->account().delivered == 1);
  rig.gate->release();
  const auto block = rig.read(*source);
  REQUIRE(block);
  CHECK(block->frame == 1);
  CHECK(block->codes[1] == 4);
  CHECK(source->account().delivered == 2);
  CHECK(source->faults() == 0);
}

TEST_CASE("hang: a frame that came when nobody waited any more is dropped by stop") {
  Rig rig;
  const auto source = rig.make().value();
  REQUIRE(source->start());
  REQUIRE(rig.read(*source));
  rig.gate->hang_at("answer");
  REQUIRE_FALSE(rig.read(*source));
  rig.gate->release();
  source->stop();
  const hal::FrameAccount account = source->account();
  CHECK(account.delivered == 1);
  CHECK(account.drops(hal::DropReason::stopped) == 1);
  CHECK(account.balanced());
}

TEST_CASE("hang: stop and close return in their time, and the device is stopped and closed when it comes back") {
  for (const char* const call : {"read", "stop", "close"}) {
    CAPTURE(std::string(call));
    Rig rig;
    auto source = rig.make().value();
    REQUIRE(source->start());
    REQUIRE(rig.read(*source));
    rig.gate->hang_at(call);
    if (std::string(call) == "read") REQUIRE_FALSE(rig.read(*source));
    const std::int64_t begun_ns = rig.now_ns();
    const auto closed = source->close();
    REQUIRE_FALSE(closed);
    check_hangs(closed.error(), ErrorCode::timeout, "reference-1", call);
    CHECK(rig.now_ns() - begun_ns <= limit_of(DeviceCall::stop).budget_ns + limit_of(DeviceCall::close).budget_ns);
    CHECK(rig.gate->passed("closed") == 0);
    CHECK(source->account().balanced());
    CHECK_FALSE(source->start());
    source.reset();
    rig.gate->release();
    rig.gate->wait_for("closed", one);
    CHECK(rig.gate->passed("stop") == 1);
  }
}

TEST_CASE("hang: the device's thread runs where its reader runs") {
  cpu_set_t before;
  REQUIRE(sched_getaffinity(0, sizeof before, &before) == 0);
  int processors = 0, last = 0;
  for (int k = 0; k < CPU_SETSIZE; ++k) {
    if (!CPU_ISSET(k, &before)) continue;
    ++processors;
    last = k;
  }
  struct Seen {
    cpu_set_t processors;
  };
  struct Where final : hal::tests::ReferenceSource {
    Where(hal::Clock& clock, std::shared_ptr<Seen> seen) : ReferenceSource(clock), seen_(std::move(seen)) {}
    hal::Result<hal::SampleBlock> do_read(std::int64_t deadline_ns) override {
      sched_getaffinity(0, sizeof seen_->processors, &seen_->processors);
      return ReferenceSource::do_read(deadline_ns);
    }
    std::shared_ptr<Seen> seen_;
  };
  Rig rig;
  const auto seen = std::make_shared<Seen>();
  const auto source =
      HangProofSource::create(
          "the eye",
          [seen](hal::Clock& by) -> hal::Result<HangProofSource::Source> { return std::make_unique<Where>(by, seen); },
          time_of(rig.clock, rig.gate), 0)
          .value();
  REQUIRE(source->start());
  cpu_set_t only;
  CPU_ZERO(&only);
  CPU_SET(last, &only);
  REQUIRE(sched_setaffinity(0, sizeof only, &only) == 0);
  CHECK(rig.read(*source).has_value());
  CHECK(sched_setaffinity(0, sizeof before, &before) == 0);
  CHECK(CPU_EQUAL(&seen->processors, &only));
  if (processors < 2) MESSAGE("one processor: nothing could be told apart");
}

TEST_CASE("hang: a machine that has no thread for it says so") {
  Rig rig;
  const test::NoThreads none;
  const auto made = rig.make();
  REQUIRE_FALSE(made);
  CHECK(made.error().code == ErrorCode::no_space);
  CHECK(rig.gate->passed("open") == 0);
}

TEST_CASE("hang: docs/faults.md has the limits") {
  const std::string page = test::bytes_of(test::source_path("docs/faults.md"));
  CHECK_MESSAGE(page.find(hang_reference()) != std::string::npos, hang_reference());
}

}  // namespace
}  // namespace compueye::device::tests
