#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "hal/clock.hpp"
#include "hal/sample_source.hpp"

/// The contract of hal::SampleSource as tests. Every back end is put through check_sample_source_contract() by a test
/// of its own, which says how to make one and which faults it can inject; what is left empty is not tested.
namespace compueye::hal::tests {

struct SourceUnderTest {
  /// A new, not started source on `clock`; at least 60 frames long if it is finite.
  std::function<std::unique_ptr<SampleSource>(Clock& clock)> make;

  /// The clock to test on; empty: virtual time from 0.
  std::function<std::unique_ptr<Clock>()> make_clock;

  /// How long a frame that has to come is waited for, besides its own time.
  std::int64_t patience_ns = 2'000'000'000;

  /// Frames come by time: a deadline before the next one is complete times out. False for sources that always have
  /// their next frame at hand (a recording replayed without pauses), and on a real clock, where the test itself may be
  /// late.
  bool paced = true;

  std::optional<std::uint64_t> frames_per_run;                   ///< length of a finite source
  std::function<void(SampleSource&, int frames)> lose_frames;    ///< the next `frames` frames are lost on the way
  std::function<void(SampleSource&, int channel)> lose_channel;  ///< from the next frame on this channel is missing
  std::function<void(SampleSource&)> disconnect;                 ///< the device goes away
  std::function<std::uint64_t()> heap_calls;  ///< by this thread so far; tests that read() makes none
};

/// Collects what a source does against its contract, one sentence each.
class ContractTest {
 public:
  explicit ContractTest(const SourceUnderTest& under_test) : test_(under_test) {}

  [[nodiscard]] std::vector<std::string> violations() {
    for (auto part :
         {&ContractTest::description, &ContractTest::order_of_calls, &ContractTest::stream, &ContractTest::restart,
          &ContractTest::deadline, &ContractTest::slow_reader, &ContractTest::lost_frames, &ContractTest::lost_channel,
          &ContractTest::disconnection, &ContractTest::end, &ContractTest::heap, &ContractTest::counters}) {
      clock_ = test_.make_clock ? test_.make_clock() : std::make_unique<VirtualClock>();
      source_ = test_.make(*clock_);
      (this->*part)();
      source_.reset();
    }
    return found_;
  }

 private:
  static constexpr int long_look = 40;  // frames
  static constexpr int soon = 10;       // frames within which an injected fault must show

  /// On a real clock the test may be late, and what was made before the fault is still handed out.
  [[nodiscard]] int in_time() const { return test_.make_clock ? 1000 : soon; }

  void expect(bool holds, const std::string& otherwise) {
    if (!holds) found_.push_back(part_ + ": " + otherwise);
  }
  [[nodiscard]] std::int64_t period_ns() const {
    const double rate = source_->describe().frame_rate_hz;
    return rate > 0.0 ? static_cast<std::int64_t>(1e9 / rate) : std::int64_t{10'000'000};
  }

  void start() {
    const auto started = source_->start();
    expect(started.has_value(), "start() failed: " + (started ? std::string() : started.error().text()));
    last_.reset();
    delivered_ = 0;
    const FrameAccount account = source_->account();
    expect(account.delivered == 0, "start() did not set the account back");
  }

  /// One frame, waited for patiently, against everything that holds for each frame.
  std::optional<SampleBlock> next() {
    const auto block = source_->read(clock_->now_ns() + 20 * period_ns() + test_.patience_ns);
    if (!block) {
      expect(false, "no frame came: " + block.error().text());
      return std::nullopt;
    }
    ++delivered_;
    check_samples(*block);
    check_order(*block);
    check_account(*block);
    last_ = *block;
    return *block;
  }

  void check_samples(const SampleBlock& block) {
    const SourceDescription& d = source_->describe();
    const auto channels = static_cast<std::size_t>(d.channels);
    expect(block.codes.size() == channels && block.valid.size() == channels,
           "a block has " + std::to_string(block.codes.size()) + " codes and " + std::to_string(block.valid.size()) +
               " validities, described are " + std::to_string(d.channels) + " channels");
    expect(block.bits == d.bits,
           "a block has " + std::to_string(block.bits) + " bits, described are " + std::to_string(d.bits));
    const std::int32_t full_scale = (std::int32_t{1} << d.bits) - 1;
    const auto outside = std::find_if(block.codes.begin(), block.codes.end(),
                                      [&](std::int32_t code) { return code < 0 || code > full_scale; });
    expect(outside == block.codes.end(), "a code is outside 0.." + std::to_string(full_scale));
  }

  void check_order(const SampleBlock& block) {
    if (!last_) return;
    expect(block.frame > last_->frame,
           "frame " + std::to_string(block.frame) + " came after frame " + std::to_string(last_->frame));
    if (!block.flags.time_ok || !last_->flags.time_ok) return;
    expect(block.t_ns > last_->t_ns,
           "time stamp " + std::to_string(block.t_ns) + " ns came after " + std::to_string(last_->t_ns) + " ns");
  }

  void check_account(const SampleBlock& block) {
    const FrameAccount account = source_->account();
    const std::string at = " at frame " + std::to_string(block.frame);
    expect(account.balanced(), "the account does not balance" + at);
    expect(account.delivered == delivered_, "delivered is " + std::to_string(account.delivered) + " after " +
                                                std::to_string(delivered_) + " frames" + at);
    // Frame numbers begin at 0, so this many were lost before or between those that came.
    const std::uint64_t lost = block.frame + 1 - delivered_;
    expect(account.total_dropped() >= lost, "the frame number has jumped by " + std::to_string(lost) + " in all, but " +
                                                std::to_string(account.total_dropped()) + " drops are counted" + at);
  }

  void description() {
    part_ = "describe";
    const SourceDescription& d = source_->describe();
    const SourceDescription before = d;
    expect(!d.backend.empty(), "the backend has no name");
    expect(!d.serial.empty(), "the source has no serial number");
    expect(d.channels >= 1, "there are no channels");
    expect(d.bits >= 1 && d.bits <= 24, "bits are " + std::to_string(d.bits) + ", expected 1 to 24");
    expect(std::isfinite(d.frame_rate_hz) && d.frame_rate_hz >= 0.0, "the frame rate is not a rate");
    const auto channels = static_cast<std::size_t>(d.channels);
    expect(d.ommatidium_of_channel.size() == channels, "the channel map does not have one entry a channel");
    std::vector<std::int32_t> sorted = d.ommatidium_of_channel;
    std::sort(sorted.begin(), sorted.end());
    expect(std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end(), "the channel map repeats an ommatidium");
    expect(sorted.empty() || (sorted.front() >= 0 && sorted.back() < d.channels),
           "the channel map names an ommatidium outside 0.." + std::to_string(d.channels - 1));

    start();
    for (int i = 0; i < 3; ++i) next();
    source_->stop();
    const SourceDescription& after = source_->describe();
    expect(&after == &d, "describe() returns another object after a run");
    expect(after.backend == before.backend && after.serial == before.serial && after.firmware == before.firmware &&
               after.channels == before.channels && after.bits == before.bits &&
               after.frame_rate_hz == before.frame_rate_hz &&
               after.ommatidium_of_channel == before.ommatidium_of_channel,
           "the description changed in a run");
  }

  void counters() {
    part_ = "counters";
    const std::vector<Counter> before = source_->counters();
    std::set<std::string_view> names;
    for (const Counter& each : before) {
      expect(!each.name.empty() && !each.meaning.empty(), "a counter has no name or no meaning");
      expect(names.insert(each.name).second, "two counters are called " + std::string(each.name));
    }
    start();
    for (int i = 0; i < 3; ++i) next();
    const std::vector<Counter> after = source_->counters();
    expect(source_->faults() == faults_in(after), "faults() is not the number of faults among the counters");
    source_->stop();
    expect(std::equal(before.begin(), before.end(), after.begin(), after.end(),
                      [](const Counter& a, const Counter& b) { return a.name == b.name; }),
           "the counters are other ones after a run");
  }

  void expect_usage(const Error& error, const std::string& call) {
    expect(error.code == ErrorCode::usage, call + " returned '" + std::string(name(error.code)) + "', expected usage");
    expect(!error.sentence.empty(), call + " gave no sentence");
  }

  void order_of_calls() {
    part_ = "order of calls";
    const auto early = source_->read(clock_->now_ns());
    expect(!early, "read() before start() returned a frame");
    if (!early) expect_usage(early.error(), "read() before start()");
    source_->stop();
    expect(!source_->started(), "a source is started that never was");
    start();
    expect(source_->started(), "started() is false after start()");
    const auto twice = source_->start();
    expect(!twice, "start() worked twice");
    if (!twice) expect_usage(twice.error(), "the second start()");
    next();
    source_->stop();
    source_->stop();
    const auto late = source_->read(clock_->now_ns());
    expect(!late, "read() after stop() returned a frame");
    if (!late) expect_usage(late.error(), "read() after stop()");
  }

  void stream() {
    part_ = "stream";
    start();
    for (int i = 0; i < long_look; ++i) {
      if (!next()) return;
    }
  }

  void restart() {
    part_ = "restart";
    for (int run = 0; run < 3; ++run) {
      start();
      const auto first = next();
      // With check_account(): a first frame other than 0 is one before which drops are counted.
      if (first && !test_.make_clock) {
        expect(first->frame < soon, "a new run began with frame " + std::to_string(first->frame));
      }
      for (int i = 0; i < 5 * run; ++i) next();
      source_->stop();
    }
  }

  void deadline() {
    part_ = "deadline";
    start();
    for (int i = 0; i < soon; ++i) {
      if (!next()) return;
      const std::uint64_t before = delivered_;
      const std::int64_t now_ns = clock_->now_ns();
      const auto nothing = source_->read(now_ns);
      if (nothing) {
        expect(!test_.paced, "a frame came before its time");
        ++delivered_;
        check_order(*nothing);
        last_ = *nothing;
        continue;
      }
      expect(nothing.error().code == ErrorCode::timeout,
             "a passed deadline returned '" + nothing.error().text() + "', expected a timeout");
      expect(nothing.error().place.empty() && nothing.error().sentence.empty(), "a timeout carries text");
      expect(source_->account().delivered == before, "a timeout was counted as a frame");
      expect(source_->account().balanced(), "the account does not balance after a timeout");
      if (!test_.make_clock) {
        expect(clock_->now_ns() == now_ns,
               "read() went on for " + std::to_string(clock_->now_ns() - now_ns) + " ns after its deadline");
      }
    }
  }

  void slow_reader() {
    part_ = "slow reader";
    start();
    for (int i = 0; i < soon; ++i) {
      if (!next()) return;
      clock_->sleep_until_ns(clock_->now_ns() + (i % 3 == 0 ? 25 : 2) * period_ns() + 1);
    }
  }

  void lost_frames() {
    if (!test_.lose_frames) return;
    part_ = "lost frames";
    start();
    for (int i = 0; i < 3; ++i) next();
    const std::uint64_t drops_before = source_->account().total_dropped();
    test_.lose_frames(*source_, 3);
    std::uint64_t jumps = 0;
    for (int i = 0; i < soon || (i < in_time() && jumps < 3); ++i) {
      // Not an optional: GCC 12 takes its value for uninitialised under the thread sanitizer.
      const bool has_before = last_.has_value();
      const std::uint64_t before = has_before ? last_->frame : 0;
      const auto block = next();
      if (!block) return;
      if (has_before) jumps += block->frame - before - 1;
    }
    const std::uint64_t drops = source_->account().total_dropped() - drops_before;
    expect(jumps == 3, "3 frames were lost, and frame numbers jumped by " + std::to_string(jumps));
    expect(drops == 3, "3 frames were lost, and " + std::to_string(drops) + " were counted");
  }

  void lost_channel() {
    if (!test_.lose_channel) return;
    part_ = "lost channel";
    start();
    next();
    const int channel = source_->describe().channels / 2;
    test_.lose_channel(*source_, channel);
    bool flagged = false;
    for (int i = 0; i < in_time() && !flagged; ++i) {
      const auto block = next();
      if (!block) return;
      flagged = block->valid[static_cast<std::size_t>(channel)] == 0;
      if (!flagged || block->valid.size() == 1) continue;
      const auto others = std::count_if(block->valid.begin(), block->valid.end(), [](auto v) { return v != 0; });
      expect(others > 0, "one lost channel made every channel invalid");
    }
    expect(flagged, "channel " + std::to_string(channel) + " was lost and is still said to be valid");
  }

  void disconnection() {
    if (!test_.disconnect) return;
    part_ = "disconnection";
    start();
    next();
    test_.disconnect(*source_);
    bool gone = false;
    for (int i = 0; i < in_time() && !gone; ++i) {
      const auto block = source_->read(clock_->now_ns() + 20 * period_ns() + test_.patience_ns);
      gone = !block && block.error().code == ErrorCode::disconnected;
      if (gone) expect(!block.error().sentence.empty(), "nothing tells the user that the device went away");
    }
    expect(gone, "the device went away and read() never said so");
    expect(!source_->read(clock_->now_ns()).has_value(), "a frame came from a device that went away");
    expect(source_->account().balanced(), "the account does not balance");
    source_->stop();
    expect(!source_->started(), "stop() did not work on a device that went away");
  }

  void end() {
    if (!test_.frames_per_run) return;
    part_ = "end of stream";
    for (int run = 0; run < 2; ++run) {
      start();
      for (std::uint64_t i = 0; i < *test_.frames_per_run; ++i) {
        if (!next()) return;
      }
      for (int again = 0; again < 3; ++again) {
        const auto over = source_->read(clock_->now_ns() + 2 * period_ns());
        expect(!over, "a frame came after the last");
        if (!over) {
          expect(over.error().code == ErrorCode::end_of_stream,
                 "after the last frame came '" + over.error().text() + "', expected the end of the stream");
          expect(over.error().place.empty() && over.error().sentence.empty(), "the end of the stream carries text");
        }
      }
      expect(source_->account().balanced(), "the account does not balance");
      source_->stop();
    }
  }

  void heap() {
    if (!test_.heap_calls) return;
    part_ = "heap";
    start();
    std::uint64_t calls = 0;
    for (int i = 0; i < long_look; ++i) {
      const std::uint64_t before = test_.heap_calls();
      {
        const auto frame = source_->read(clock_->now_ns() + 20 * period_ns());
        const auto timeout = source_->read(clock_->now_ns());
      }
      calls += test_.heap_calls() - before;
    }
    expect(calls == 0, "read() used the heap " + std::to_string(calls) + " times in 80 calls");
  }

  const SourceUnderTest& test_;
  std::unique_ptr<Clock> clock_;
  std::unique_ptr<SampleSource> source_;
  std::string part_;
  std::vector<std::string> found_;
  std::optional<SampleBlock> last_;  // only its numbers are looked at: its samples are gone after the next read
  std::uint64_t delivered_ = 0;
};

[[nodiscard]] inline std::vector<std::string> sample_source_violations(const SourceUnderTest& under_test) {
  return ContractTest(under_test).violations();
}

/// Call inside a TEST_CASE: one failed check for every violation.
inline void check_sample_source_contract(const SourceUnderTest& under_test) {
  REQUIRE(under_test.make);
  const std::vector<std::string> violations = sample_source_violations(under_test);
  for (const std::string& violation : violations) FAIL_CHECK(violation);
  CHECK(violations.empty());
}

}  // namespace compueye::hal::tests
