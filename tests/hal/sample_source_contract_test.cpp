#include "tests/hal/sample_source_contract.hpp"

#include <doctest/doctest.h>

#include <memory>
#include <string>
#include <vector>

#include "tests/hal/reference_source.hpp"
#include "tests/memory/allocation_counter.hpp"

using namespace compueye::hal;
using namespace compueye::hal::tests;

namespace {

ReferenceSource& reference(SampleSource& source) {
  return static_cast<ReferenceSource&>(source);
}

template <class Source = ReferenceSource>
SourceUnderTest with_every_fault() {
  SourceUnderTest test;
  test.make = [](Clock& clock) { return std::make_unique<Source>(clock); };
  test.lose_frames = [](SampleSource& s, int frames) { reference(s).lose_frames(frames); };
  test.lose_channel = [](SampleSource& s, int channel) { reference(s).lose_channel(channel); };
  test.disconnect = [](SampleSource& s) { reference(s).disconnect(); };
  test.heap_calls = [] { return compueye::tests::heap_use_of_this_thread().calls(); };
  return test;
}

/// True when a violation of that part of the contract was found.
bool found(const std::vector<std::string>& violations, const std::string& part) {
  for (const std::string& violation : violations) {
    if (violation.rfind(part + ":", 0) == 0) return true;
  }
  return false;
}

// Each of these breaks the contract in one way that a real driver has broken it.

struct RepeatsFrame final : ReferenceSource {
  using ReferenceSource::ReferenceSource;
  SampleBlock make_block(bool overrun) override {
    SampleBlock block = ReferenceSource::make_block(overrun);
    if (block.frame == 7) block.frame = 6;
    return block;
  }
};

struct ForgetsLosses final : ReferenceSource {
  using ReferenceSource::ReferenceSource;
  FrameAccount do_account() const noexcept override {
    FrameAccount account = account_;
    account.dropped = {};
    account.produced = account.delivered;
    return account;
  }
};

struct CountsOnAcrossRuns final : ReferenceSource {
  using ReferenceSource::ReferenceSource;
  Result<void> do_start() override {
    const std::uint64_t next = next_;
    const auto done = ReferenceSource::do_start();
    next_ = next;
    began_ns_ -= static_cast<std::int64_t>(next) * period_ns;
    return done;
  }
};

struct HidesMissingChannel final : ReferenceSource {
  using ReferenceSource::ReferenceSource;
  SampleBlock make_block(bool overrun) override {
    const SampleBlock block = ReferenceSource::make_block(overrun);
    std::fill(valid_.begin(), valid_.end(), std::uint8_t{1});
    return block;
  }
};

struct ExceedsItsBits final : ReferenceSource {
  using ReferenceSource::ReferenceSource;
  SampleBlock make_block(bool overrun) override {
    const SampleBlock block = ReferenceSource::make_block(overrun);
    if (block.frame == 30) codes_[3] = 1 << bits;
    return block;
  }
};

struct TurnsTimeBack final : ReferenceSource {
  using ReferenceSource::ReferenceSource;
  SampleBlock make_block(bool overrun) override {
    SampleBlock block = ReferenceSource::make_block(overrun);
    if (block.frame == 20) block.t_ns -= 2 * period_ns;
    return block;
  }
};

struct OversleepsDeadline final : ReferenceSource {
  using ReferenceSource::ReferenceSource;
  Result<SampleBlock> do_read(std::int64_t deadline_ns) override {
    auto block = ReferenceSource::do_read(deadline_ns);
    if (!block) clock_.sleep_until_ns(deadline_ns + period_ns / 2);
    return block;
  }
};

struct UsesTheHeap final : ReferenceSource {
  using ReferenceSource::ReferenceSource;
  SampleBlock make_block(bool overrun) override {
    codes_ = std::vector<std::int32_t>(codes_.size());
    return ReferenceSource::make_block(overrun);
  }
};

struct RepeatsOmmatidium final : ReferenceSource {
  explicit RepeatsOmmatidium(Clock& clock) : ReferenceSource(clock) { description_.ommatidium_of_channel[1] = 0; }
};

struct ExplainsTimeouts final : ReferenceSource {
  using ReferenceSource::ReferenceSource;
  Result<SampleBlock> do_read(std::int64_t deadline_ns) override {
    auto block = ReferenceSource::do_read(deadline_ns);
    if (!block && block.error().code == ErrorCode::timeout) block.error().sentence = "nothing came";
    return block;
  }
};

}  // namespace

TEST_CASE("the reference source keeps the contract of sample sources") {
  check_sample_source_contract(with_every_fault());
}

TEST_CASE("a finite source keeps the contract to its end and again after it") {
  SourceUnderTest test = with_every_fault();
  test.make = [](Clock& clock) { return std::make_unique<ReferenceSource>(clock, 60); };
  test.frames_per_run = 60;
  check_sample_source_contract(test);
}

TEST_CASE("the contract also holds in real time") {
  SourceUnderTest test = with_every_fault();
  test.make_clock = [] { return std::make_unique<MonotonicClock>(); };
  // A busy machine may oversleep by a frame, and then the next one is there before its read; how many frames are lost
  // is then not only in the hands of the test either.
  test.paced = false;
  test.lose_frames = {};
  check_sample_source_contract(test);
}

TEST_CASE("the contract suite finds each way of breaking it") {
  CHECK(found(sample_source_violations(with_every_fault<RepeatsFrame>()), "stream"));
  CHECK(found(sample_source_violations(with_every_fault<ForgetsLosses>()), "lost frames"));
  CHECK(found(sample_source_violations(with_every_fault<ForgetsLosses>()), "slow reader"));
  CHECK(found(sample_source_violations(with_every_fault<CountsOnAcrossRuns>()), "restart"));
  CHECK(found(sample_source_violations(with_every_fault<HidesMissingChannel>()), "lost channel"));
  CHECK(found(sample_source_violations(with_every_fault<ExceedsItsBits>()), "stream"));
  CHECK(found(sample_source_violations(with_every_fault<TurnsTimeBack>()), "stream"));
  CHECK(found(sample_source_violations(with_every_fault<OversleepsDeadline>()), "deadline"));
  CHECK(found(sample_source_violations(with_every_fault<UsesTheHeap>()), "heap"));
  CHECK(found(sample_source_violations(with_every_fault<RepeatsOmmatidium>()), "describe"));
  CHECK(found(sample_source_violations(with_every_fault<ExplainsTimeouts>()), "deadline"));
}

TEST_CASE("the contract suite finds a device that goes away without a word and a stream that never ends") {
  SourceUnderTest silent = with_every_fault();
  silent.disconnect = [](SampleSource&) {};
  CHECK(found(sample_source_violations(silent), "disconnection"));

  SourceUnderTest endless = with_every_fault();
  endless.frames_per_run = 60;
  CHECK(found(sample_source_violations(endless), "end of stream"));
}
