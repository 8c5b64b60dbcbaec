// Real sources behind device::HangProofSource: the same frames as without it, and a hang in every call of every wire.

#include <doctest/doctest.h>

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "drivers/device/hang_proof_eye.hpp"
#include "drivers/device/hang_proof_source.hpp"
#include "tests/drivers/device/converter_rig.hpp"
#include "tests/drivers/device/eye_rig.hpp"
#include "tests/drivers/device/hang_gate.hpp"
#include "tests/drivers/device/hanging_source.hpp"
#include "tests/drivers/device/hanging_wires.hpp"
#include "tests/hal/sample_source_contract.hpp"
#include "tests/memory/allocation_counter.hpp"

namespace compueye::device::tests {
namespace {

using hal::ErrorCode;

/// A frame, kept.
struct Kept {
  std::vector<std::int32_t> codes;
  std::vector<std::uint8_t> valid;
  std::uint64_t frame = 0;
  std::int64_t t_ns = 0;
  std::uint32_t config_id = 0;
  bool overrun = false, saturated = false, time_ok = false;
  bool operator==(const Kept&) const = default;
};

Kept kept(const hal::SampleBlock& block) {
  return {{block.codes.begin(), block.codes.end()},
          {block.valid.begin(), block.valid.end()},
          block.frame,
          block.t_ns,
          block.config_id,
          block.flags.overrun,
          block.flags.saturated,
          block.flags.time_ok};
}

/// All that a reader sees of so many reads, of which some come after a pause.
std::pair<std::vector<Kept>, hal::FrameAccount> film_of(hal::SampleSource& source, hal::Clock& clock) {
  std::vector<Kept> frames;
  REQUIRE(source.start());
  for (int k = 0; k < 200; ++k) {
    if (k % 50 == 49) clock.sleep_until_ns(clock.now_ns() + 77 * ms);
    const auto block = source.read(clock.now_ns() + 35 * ms);
    if (block) frames.push_back(kept(*block));
  }
  source.stop();
  return {frames, source.account()};
}

/// Converters on an emulated machine, all of which what hangs keeps alive.
struct Converters {
  explicit Converters(const ConverterEye& eye)
      : chips(std::make_shared<frontend::EmulatedFrontEnd>(emulated(eye), clock->now_ns())) {}

  [[nodiscard]] hal::Result<std::unique_ptr<ConverterSource>> bare(hal::Clock& by) const {
    return ConverterSource::create(source_of(*chips), wires_of(*chips, by), by);
  }
  [[nodiscard]] HangProofSource::Open open() const {
    return [chips = chips, gate = gate](hal::Clock& by) -> hal::Result<HangProofSource::Source> {
      auto wires = wires_of(*chips, by);
      wires.sync = std::make_unique<NoSync>();
      auto made = ConverterSource::create(source_of(*chips), hanging(std::move(wires), gate), by);
      if (!made) return tl::unexpected(made.error());
      return std::move(*made);
    };
  }
  [[nodiscard]] hal::Result<std::unique_ptr<HangProofSource>> make(std::size_t ahead = 0) const {
    return HangProofSource::create("converters", open(), time_of(clock, gate), ahead);
  }

  struct NoSync final : hal::OutputLines {
    [[nodiscard]] const std::string& name() const noexcept override { return name_; }
    [[nodiscard]] int count() const noexcept override { return 1; }
    [[nodiscard]] hal::Result<void> open() override { return {}; }
    void close() noexcept override {}
    [[nodiscard]] hal::Result<void> set(std::uint32_t) override { return {}; }
    std::string name_ = "sync";
  };

  std::shared_ptr<hal::VirtualClock> clock = std::make_shared<hal::VirtualClock>(5 * second);
  Gate gate = std::make_shared<HangGate>();
  std::shared_ptr<frontend::EmulatedFrontEnd> chips;
};

/// An eye on a cable, likewise.
struct Cable {
  explicit Cable(const Bus* on)
      : bus(on),
        eye(std::make_shared<protocol::DeviceEmulator>(
            protocol::DeviceEmulator::create(protocol::tests::eye_settings(on, 64), protocol::tests::shown(12),
                                             clock->now_ns())
                .value())) {}

  [[nodiscard]] hal::Result<std::unique_ptr<HangProofEye>> make(std::size_t ahead = 0) const {
    return HangProofEye::create(
        "cable",
        [bus = bus, eye = eye, gate = gate](hal::Clock& by) {
          return DeviceSource::create(
              source_settings(bus),
              std::make_unique<HangingTransport>(std::make_unique<protocol::EmulatedTransport>(*eye, by), gate), by);
        },
        time_of(clock, gate), ahead);
  }

  const Bus* bus;
  std::shared_ptr<hal::VirtualClock> clock = std::make_shared<hal::VirtualClock>(10 * second);
  Gate gate = std::make_shared<HangGate>();
  std::shared_ptr<protocol::DeviceEmulator> eye;
};

/// Plays one hang of `call`, the n-th one after the run began: what a reader must be able to rely on all the same.
/// Returns whether it was ever made.
bool hold_up(HangProofSource& source, hal::VirtualClock& clock, HangGate& gate, const std::string& call, int nth) {
  CAPTURE(call);
  CAPTURE(nth);
  REQUIRE(source.start());
  std::uint64_t next = 0, delivered = 0;
  const auto read = [&] {
    const bool hung = gate.hangs();
    const std::int64_t deadline_ns = clock.now_ns() + 100 * ms;
    const auto block = source.read(deadline_ns);
    // Where nothing hangs, recovery takes what the chips take, and time goes as far as that.
    if (hung) REQUIRE(clock.now_ns() <= deadline_ns + latest_answer_ns);
    const hal::FrameAccount account = source.account();
    REQUIRE(account.balanced());
    if (!block) {
      REQUIRE_MESSAGE(block.error().code == ErrorCode::timeout, block.error().text());
      return false;
    }
    REQUIRE(block->frame >= next);
    next = block->frame + 1;
    ++delivered;
    REQUIRE(account.delivered == delivered);
    REQUIRE(account.produced >= next);
    return true;
  };
  for (int k = 0; k < 5; ++k) read();
  gate.hang_at(call, nth);
  for (const std::int64_t until_ns = clock.now_ns() + 600 * ms; clock.now_ns() < until_ns && !gate.hangs();) read();
  const bool came = gate.hangs();
  // What was read ahead is the reader's, whatever hangs behind it.
  std::size_t before = 0;
  while (came && read()) ++before;
  CHECK(before <= HangProofSource::usual_ahead);
  for (int k = 0; came && k < 30; ++k) CHECK_FALSE(read());
  if (came) CHECK(source.recovering());
  gate.release();
  int whole = 0;
  for (int k = 0; k < 100 && whole < 10; ++k) whole += read() ? 1 : 0;
  CHECK(whole == 10);
  const std::int64_t stopped_ns = clock.now_ns();
  source.stop();
  CHECK(clock.now_ns() - stopped_ns <= limit_of(DeviceCall::stop).budget_ns);
  CHECK(source.account().balanced());
  return came;
}

}  // namespace

TEST_CASE("hang: frames that are read ahead are the same, bit for bit, and none is lost on the way") {
  static constexpr std::size_t frames = 150;
  const auto first_of = [](hal::SampleSource& source, hal::Clock& clock) {
    std::vector<Kept> all;
    REQUIRE(source.start());
    while (all.size() < frames) {
      const auto block = source.read(clock.now_ns() + 35 * ms);
      if (block) all.push_back(kept(*block));
      REQUIRE(source.account().delivered == all.size());
      REQUIRE(source.account().balanced());
    }
    source.stop();
    const hal::FrameAccount account = source.account();
    CHECK(account.balanced());
    CHECK(account.delivered == frames);
    CHECK(account.total_dropped() == account.drops(hal::DropReason::stopped));
    CHECK(account.total_dropped() <= HangProofSource::usual_ahead + 2);
    return all;
  };
  for (const ConverterEye& eye : converter_eyes) {
    CAPTURE(eye.chip);
    const Converters alone(eye), aside(eye);
    const auto bare = alone.bare(*alone.clock).value();
    const auto proof = aside.make(HangProofSource::usual_ahead).value();
    CHECK(first_of(*proof, *aside.clock) == first_of(*bare, *alone.clock));
  }
  for (const Bus* const bus : protocol::buses) {
    CAPTURE(std::string(bus->name));
    const Cable one(bus), other(bus);
    const auto without = one.make(0).value(), with = other.make(HangProofSource::usual_ahead).value();
    CHECK(first_of(*with, *other.clock) == first_of(*without, *one.clock));
  }
}

TEST_CASE("hang: converters behind a thread of their own keep the contract of sources") {
  for (const ConverterEye& eye : converter_eyes) {
    CAPTURE(eye.chip);
    hal::tests::SourceUnderTest test;
    const auto gate = std::make_shared<HangGate>();
    const auto chips = std::make_shared<std::shared_ptr<frontend::EmulatedFrontEnd>>();
    test.make = [=](hal::Clock& clock) -> std::unique_ptr<hal::SampleSource> {
      *chips = std::make_shared<frontend::EmulatedFrontEnd>(emulated(eye), clock.now_ns());
      const auto open = [on = *chips](hal::Clock& by) -> hal::Result<HangProofSource::Source> {
        ConverterSettings settings = source_of(*on);
        settings.recovery_limit_ns = 0;
        return std::move(ConverterSource::create(settings, wires_of(*on, by), by).value());
      };
      const std::shared_ptr<hal::Clock> lent(std::shared_ptr<void>(), &clock);
      return std::move(HangProofSource::create("converters", open, time_of(lent, gate), 0).value());
    };
    test.heap_calls = [] { return compueye::tests::heap_use_of_this_thread().calls(); };
    test.disconnect = [=](hal::SampleSource&) { (*chips)->inject({.kind = frontend::FrontEndFaultKind::gone}); };
    hal::tests::check_sample_source_contract(test);
  }
}

TEST_CASE("hang: converters behind a thread of their own give the same frames, bit for bit, and the same books") {
  for (const ConverterEye& eye : converter_eyes) {
    CAPTURE(eye.chip);
    const Converters alone(eye), aside(eye);
    for (const Converters* const each : {&alone, &aside}) {
      each->chips->inject({.kind = frontend::FrontEndFaultKind::bus_error, .at_ns = 5 * second + 300 * ms});
      each->chips->inject({.kind = frontend::FrontEndFaultKind::brown_out, .at_ns = 5 * second + 600 * ms});
    }
    const auto bare = alone.bare(*alone.clock).value();
    const auto proof = aside.make().value();
    const auto expected = film_of(*bare, *alone.clock);
    const auto film = film_of(*proof, *aside.clock);
    REQUIRE(expected.first.size() > 100);
    CHECK(film.first == expected.first);
    CHECK(film.second.produced == expected.second.produced);
    CHECK(film.second.dropped == expected.second.dropped);
    CHECK(alone.clock->now_ns() == aside.clock->now_ns());
    CHECK(proof->faults() == bare->faults());
    CHECK(proof->outages() == bare->outages());
  }
}

TEST_CASE("hang: an eye on a cable behind a thread of its own gives the same frames, bit for bit, and the same books") {
  for (const Bus* const bus : protocol::buses) {
    CAPTURE(std::string(bus->name));
    const Cable alone(bus), aside(bus);
    for (const Cable* const each : {&alone, &aside}) {
      each->eye->inject({.kind = FaultKind::lose_packets, .at_ns = 10 * second + 400 * ms, .count = 7});
    }
    const auto bare =
        DeviceSource::create(source_settings(bus),
                             std::make_unique<protocol::EmulatedTransport>(*alone.eye, *alone.clock), *alone.clock)
            .value();
    const auto proof = aside.make().value();
    CHECK(proof->exposure_ns() == bare->exposure_ns());
    CHECK(proof->descriptor().serial == bare->descriptor().serial);
    for (EyeControls* const each : {static_cast<EyeControls*>(bare.get()), static_cast<EyeControls*>(proof.get())}) {
      CHECK(each->set_exposure(2 * ms));
      CHECK(each->exposure_ns() == 2 * ms);
      CHECK(each->set_exposure(3600 * second).error().code == ErrorCode::out_of_range);
      CHECK(each->exposure_ns() == 2 * ms);
    }
    const auto expected = film_of(*bare, *alone.clock);
    const auto film = film_of(*proof, *aside.clock);
    REQUIRE(expected.first.size() > 100);
    CHECK(film.first == expected.first);
    CHECK(film.second.produced == expected.second.produced);
    CHECK(film.second.dropped == expected.second.dropped);
    CHECK(alone.clock->now_ns() == aside.clock->now_ns());
  }
}

TEST_CASE("hang: no call of an SPI bus or a line that hangs holds read or stop, and frames come again behind it") {
  const std::vector<std::string> calls{"data exchange", "select set", "reset set", "sync set", "ready wait"};
  for (const ConverterEye& eye : converter_eyes) {
    CAPTURE(eye.chip);
    int came = 0;
    for (const std::string& call : calls) {
      for (const int nth : {1, 2, 7}) {
        for (const std::size_t ahead : aheads) {
          const Converters on(eye);
          const auto source = on.make(ahead).value();
          came += hold_up(*source, *on.clock, *on.gate, call, nth) ? 1 : 0;
        }
      }
    }
    CHECK(came >= 12);
  }
}

TEST_CASE("hang: nor one that recovery makes") {
  for (const ConverterEye& eye : converter_eyes) {
    const frontend::FrontEndRow& chip = *frontend::find_front_end(eye.chip);
    const std::vector<std::pair<std::string, bool>> calls{{"data open", true},
                                                          {"data close", true},
                                                          {"settings exchange", chip.settings_bus},
                                                          {"reset set", eye.chip != "mcp3208"},
                                                          {"ready open", chip.data_ready},
                                                          {"ready close", chip.data_ready}};
    for (const auto& call : calls) {
      CAPTURE(eye.chip);
      CAPTURE(call.first);
      for (const std::size_t ahead : aheads) {
        const Converters on(eye);
        const auto source = on.make(ahead).value();
        on.chips->inject({.kind = frontend::FrontEndFaultKind::gone,
                          .at_ns = on.clock->now_ns() + 300 * ms,
                          .duration_ns = 100 * ms});
        const bool came = hold_up(*source, *on.clock, *on.gate, call.first, 1);
        CHECK(came == call.second);
      }
    }
  }
}

TEST_CASE("hang: no call of a cable that hangs holds read or stop, and frames come again behind it") {
  for (const Bus* const bus : protocol::buses) {
    CAPTURE(std::string(bus->name));
    for (const char* const call : {"cable read", "cable control", "cable open", "cable close"}) {
      for (const int nth : {1, 2, 5}) {
        for (const std::size_t ahead : aheads) {
          const Cable on(bus);
          const auto source = on.make(ahead).value();
          on.eye->inject({.kind = FaultKind::unplug, .at_ns = on.clock->now_ns() + 300 * ms, .duration_ns = 50 * ms});
          const bool came = hold_up(*source, *on.clock, *on.gate, call, nth);
          CHECK((came || nth > 1));
        }
      }
    }
  }
}

TEST_CASE("hang: a lamp that does not answer is an error in its time, and frames go on when it does") {
  const Cable on(&usb_bus);
  const auto eye = on.make().value();
  REQUIRE(eye->start());
  REQUIRE(eye->read(on.clock->now_ns() + second));
  on.gate->hang_at("cable control");
  const std::int64_t begun_ns = on.clock->now_ns();
  const auto lit = eye->set_illumination({});
  REQUIRE_FALSE(lit);
  CHECK(lit.error().code == ErrorCode::timeout);
  CHECK(lit.error().sentence.find("'set'") != std::string::npos);
  CHECK(on.clock->now_ns() - begun_ns == limit_of(DeviceCall::set).budget_ns);
  CHECK(eye->read(on.clock->now_ns() + 100 * ms).error().code == ErrorCode::timeout);
  CHECK(eye->recovering());
  on.gate->release();
  CHECK(eye->read(on.clock->now_ns() + 10 * second));
  CHECK_FALSE(eye->recovering());
}

}  // namespace compueye::device::tests
