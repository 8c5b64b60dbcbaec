// What a user of device::DeviceSource sees of set-up, recovery and the end of it. Each fault alone: tests/hil/level1.

#include "tests/drivers/device/eye_rig.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/memory/allocation_counter.hpp"

using namespace compueye;
using namespace compueye::device;
using namespace compueye::device::tests;
using hal::DropReason;
using hal::ErrorCode;
using protocol::buses;
using protocol::tests::eye_settings;

TEST_CASE("an eye is described as its descriptor says") {
  for (const Bus* const bus : buses) {
    const auto emulator = eye_settings(bus, 100, 5);
    EyeRig rig(emulator);
    const hal::SourceDescription& d = rig.source().describe();
    CHECK(d.backend == (bus == &hid_bus ? "hid" : "usb"));
    CHECK(d.serial == emulator.descriptor.serial);
    CHECK(d.firmware == emulator.descriptor.firmware);
    CHECK(d.channels == 100);
    CHECK(d.bits == 12);
    CHECK(d.frame_rate_hz == doctest::Approx(100.0));
    CHECK(d.ommatidium_of_channel == emulator.descriptor.ommatidium_of_channel);
    CHECK(rig.source().descriptor() == emulator.descriptor);
  }
}

TEST_CASE("an eye of any size and depth streams without a loss, from the first frame to the last") {
  struct Eye {
    const Bus* bus;
    int channels, bits;
    std::uint16_t most_payload;
  };
  const Eye eyes[] = {{&usb_bus, 1, 12, 65535},     {&usb_bus, 64, 16, 65535}, {&usb_bus, 6400, 24, 1000},
                      {&usb_bus, 65535, 12, 65535}, {&hid_bus, 1, 12, 65535},  {&hid_bus, 37, 8, 65535},
                      {&hid_bus, 200, 12, 65535}};
  for (const Eye& eye : eyes) {
    CAPTURE(eye.channels);
    auto emulator = eye_settings(eye.bus, eye.channels);
    emulator.descriptor = protocol::tests::descriptor_of(eye.channels, eye.bits);
    emulator.descriptor.most_payload = eye.most_payload;
    emulator.fifo_bytes = std::size_t{1} << 21U;
    EyeRig rig(emulator);
    for (int run = 0; run < 2; ++run) {
      REQUIRE(rig.start());
      for (std::uint64_t f = 0; f < 20; ++f) {
        const auto block = rig.read();
        REQUIRE(block);
        CHECK(block->frame == f);
        CHECK(block->flags.time_ok);
      }
      rig.source().stop();
      const hal::FrameAccount account = rig.source().account();
      CHECK(account.produced == rig.shown.made());
      CHECK(account.total_dropped() == account.drops(DropReason::stopped));
      CHECK(rig.invalid_channels() == 0);
      CHECK(hal::text_of(rig.source().counters()).empty());
    }
  }
}

TEST_CASE("no eye, another eye, another version: create() and start() say so with the serial") {
  for (const Bus* const bus : buses) {
    CAPTURE(bus == &hid_bus);
    DeviceSettings ours = source_settings(bus);
    ours.serial = "CE-77";
    const EyeRig other(eye_settings(bus), ours);
    test::check_error(other.made(), ErrorCode::not_found, "CE-77", {"CE-77", "CE-1"});
    CHECK(other.clock.now_ns() - 10 * second <= 3 * second);

    auto gone = eye_settings(bus);
    gone.faults.push_back({.kind = FaultKind::unplug});
    const EyeRig absent(gone);
    REQUIRE_FALSE(absent.made());
    CHECK(absent.made().error().code == ErrorCode::not_found);

    auto newer = eye_settings(bus);
    newer.faults.push_back({.kind = FaultKind::other_version, .value = 0x20});
    const EyeRig unsupported(newer);
    test::check_error(unsupported.made(), ErrorCode::unsupported, "emulator " + std::string(bus->name), {"2.0", "1.0"});

    auto mute = eye_settings(bus);
    mute.boot_ns = 3600 * second;
    mute.faults.push_back({.kind = FaultKind::unplug, .duration_ns = 1});
    const EyeRig silent(mute);
    REQUIRE_FALSE(silent.made());
    CHECK(silent.made().error().code == ErrorCode::timeout);
    CHECK_FALSE(silent.made().error().sentence.empty());

    EyeRig echo(eye_settings(bus));
    echo.inject({.kind = FaultKind::wrong_echo, .count = 100});
    const auto started = echo.start();
    REQUIRE_FALSE(started);
    CHECK(started.error().code == ErrorCode::mismatch);
    CHECK(started.error().place == "CE-1");
  }
}

TEST_CASE("when recovery is given up read() says why, again and again, and a new start works") {
  for (const Bus* const bus : buses) {
    DeviceSettings settings = source_settings(bus);
    settings.recovery_limit_ns = 3 * second;
    EyeRig rig(eye_settings(bus), settings);
    REQUIRE(rig.start());
    for (int f = 0; f < 5; ++f) REQUIRE(rig.read());
    rig.inject({.kind = FaultKind::unplug, .duration_ns = 20 * second});
    const std::int64_t unplugged_ns = rig.clock.now_ns();
    auto block = rig.next_frame();
    test::check_error(block, ErrorCode::disconnected, "CE-1", {"3.1"});
    const auto last = protocol::EmulatedTransport(rig.device, rig.clock).open();  // what it failed with, over and over
    REQUIRE_FALSE(last);
    CHECK(block.error().sentence.find(last.error().sentence) != std::string::npos);
    CHECK(rig.clock.now_ns() - unplugged_ns >= 3 * second);
    CHECK(rig.clock.now_ns() - unplugged_ns <= 3 * second + 600 * ms);
    CHECK(rig.read().error().code == ErrorCode::disconnected);
    CHECK(rig.source().state() == MachineState::given_up);
    CHECK(rig.source().failures()[Failure::gave_up] == 1);
    CHECK(rig.source().account().produced == rig.shown.made());
    rig.source().stop();
    rig.clock.advance(20 * second);
    REQUIRE(rig.start());
    REQUIRE(rig.read());
    CHECK(rig.source().failures()[Failure::gave_up] == 0);
  }
}

TEST_CASE("frames come again within 2 s after the eye was plugged in again, however long it was away") {
  std::int64_t worst_ns = 0;
  for (const Bus* const bus : buses) {
    for (std::uint64_t seed = 1; seed <= 16; ++seed) {
      CAPTURE(seed);
      EyeRig rig(eye_settings(bus, 64, seed));
      REQUIRE(rig.start());
      for (int f = 0; f < 5; ++f) REQUIRE(rig.read());
      const std::int64_t away_ns = static_cast<std::int64_t>(seed * seed) * 97 * ms + 1;
      const std::int64_t back_ns = rig.clock.now_ns() + away_ns;
      rig.inject({.kind = FaultKind::unplug, .duration_ns = away_ns});
      while (rig.clock.now_ns() < back_ns) CHECK(rig.read(10 * ms).error().code == ErrorCode::timeout);
      REQUIRE(rig.next_frame());
      worst_ns = std::max(worst_ns, rig.clock.now_ns() - back_ns);
    }
  }
  MESSAGE("streaming again at most " << worst_ns / ms << " ms after the re-plug");
  CHECK(worst_ns <= 2 * second);
}

TEST_CASE("an eye that comes back with other channels is refused") {
  // Two devices behind one cable: the emulator changes its serial, but not its size.
  class Cable final : public hal::ByteTransport {
   public:
    Cable(protocol::DeviceEmulator& first, protocol::DeviceEmulator& second_one, hal::Clock& clock)
        : first_(first, clock), second_(second_one, clock) {}
    const hal::TransportDescription& describe() const noexcept override { return now().describe(); }
    hal::Result<void> open() override {
      swapped_ = opened_++ > 0;
      return now().open();
    }
    void close() noexcept override { now().close(); }
    hal::Result<std::size_t> read(std::span<std::byte> into, std::int64_t deadline_ns) override {
      return now().read(into, deadline_ns);
    }
    hal::Result<void> write(std::span<const std::byte> from, std::int64_t deadline_ns) override {
      return now().write(from, deadline_ns);
    }
    hal::Result<std::size_t> control(std::uint8_t request, std::span<const std::byte> payload,
                                     std::span<std::byte> reply, std::int64_t deadline_ns) override {
      return now().control(request, payload, reply, deadline_ns);
    }

   private:
    hal::ByteTransport& now() { return swapped_ ? second_ : first_; }
    [[nodiscard]] const hal::ByteTransport& now() const { return swapped_ ? second_ : first_; }
    protocol::EmulatedTransport first_, second_;
    bool swapped_ = false;
    int opened_ = 0;
  };
  for (const Bus* const bus : buses) {
    hal::VirtualClock clock;
    auto make = [&](int channels) {
      auto emulator = eye_settings(bus, channels);
      return protocol::DeviceEmulator::create(emulator, protocol::tests::shown(12)).value();
    };
    protocol::DeviceEmulator before = make(64), after = make(65);
    auto source =
        DeviceSource::create(source_settings(bus), std::make_unique<Cable>(before, after, clock), clock).value();
    REQUIRE(source->start());
    REQUIRE(source->read(clock.now_ns() + second));
    before.inject({.kind = FaultKind::unplug, .at_ns = clock.now_ns()});
    auto block = source->read(clock.now_ns() + second);
    test::check_error(block, ErrorCode::disconnected, "CE-1", {"65", "12"});
    CHECK(source->failures()[Failure::other_descriptor] == 1);
    CHECK(source->account().balanced());
  }
}

TEST_CASE("a reader that comes late loses frames to the device's memory, and only those") {
  for (const Bus* const bus : buses) {
    CAPTURE(bus == &hid_bus);
    auto emulator = eye_settings(bus, 64);
    emulator.fifo_bytes = 4096;
    EyeRig rig(emulator);
    REQUIRE(rig.start());
    for (int f = 0; f < 3; ++f) REQUIRE(rig.read());
    rig.clock.advance(20 * second);
    for (int f = 0; f < 60; ++f) REQUIRE(rig.read());
    rig.source().stop();
    const hal::FrameAccount account = rig.source().account();
    CHECK(account.produced == rig.shown.made());
    CHECK(account.drops(DropReason::device_overrun) == rig.device.truth().frames_overrun);
    CHECK(account.drops(DropReason::device_overrun) > 1900);
    CHECK(rig.source().failures()[Failure::restart] == 0);
  }
}

TEST_CASE("a reader with deadlines shorter than a request recovers nothing, but is told so and loses no account") {
  for (const Bus* const bus : buses) {
    for (const std::int64_t wanted : {400 * ms, 40 * second}) {
      EyeRig rig(eye_settings(bus));
      REQUIRE(rig.start());
      for (int f = 0; f < 3; ++f) REQUIRE(rig.read());
      rig.inject({.kind = FaultKind::stall_stream});
      const std::int64_t until_ns = rig.clock.now_ns() + wanted;
      auto block = rig.read(ms / 5);
      while (!block && block.error().code == ErrorCode::timeout && rig.clock.now_ns() < until_ns) {
        block = rig.read(ms / 5);
      }
      REQUIRE_FALSE(block);
      CHECK(rig.source().failures()[Failure::request_timeout] > 0);
      if (wanted > second) {
        CHECK(block.error().code == ErrorCode::disconnected);
        CHECK(rig.clock.now_ns() <= until_ns);
      } else {
        REQUIRE(rig.next_frame());
        rig.source().stop();
        CHECK(rig.source().account().produced == rig.shown.made());
      }
      CHECK(rig.source().account().balanced());
    }
  }
}

TEST_CASE("reading uses the heap neither for frames, nor for damage, nor for time-outs") {
  for (const Bus* const bus : buses) {
    auto emulator = eye_settings(bus, 640);
    emulator.fifo_bytes = 16384;
    std::uint64_t at_frame = 10;
    for (const FaultKind kind : {FaultKind::bit_error, FaultKind::short_read, FaultKind::lose_packets,
                                 FaultKind::duplicate_packets, FaultKind::overrun, FaultKind::clock_jump}) {
      emulator.faults.push_back({.kind = kind, .at_frame = at_frame += 5, .count = 3, .value = second});
    }
    EyeRig rig(emulator);
    REQUIRE(rig.start());
    DeviceSource& source = rig.source();
    int frames = 0;
    const auto before = compueye::tests::heap_use_of_this_thread();
    for (int f = 0; f < 100; ++f) {
      const auto block = source.read(rig.clock.now_ns() + 100 * ms);
      frames += block ? 1 : 0;
      const auto late = source.read(rig.clock.now_ns());
      static_cast<void>(late);
    }
    const auto used = compueye::tests::heap_use_of_this_thread() - before;
    CHECK(used.calls() == 0);
    CHECK(frames > 90);
  }
}
