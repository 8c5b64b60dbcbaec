// The contract of hal::SampleSource on eyes behind both buses: level 1 of the ladder.

#include <memory>

#include "tests/drivers/device/eye_rig.hpp"
#include "tests/hal/sample_source_contract.hpp"
#include "tests/memory/allocation_counter.hpp"

using namespace compueye;
using namespace compueye::device;
using namespace compueye::device::tests;
using hal::tests::check_sample_source_contract;
using hal::tests::SourceUnderTest;

namespace {

/// Frames of two packets or reports each, the channel in the middle in the first; nothing else in the stream, so that
/// a count of packets is one of frames.
protocol::EmulatorSettings two_part_eye(const Bus* bus) {
  protocol::EmulatorSettings settings = protocol::tests::eye_settings(bus, 64);
  settings.events = false;
  settings.descriptor.most_payload = 75;
  return settings;
}

SourceUnderTest eye_under_test(const Bus* bus, DeviceSettings wanted) {
  // The contract has one source at a time, and its eye has to outlive it.
  auto device = std::make_shared<std::unique_ptr<protocol::DeviceEmulator>>();
  SourceUnderTest test;
  test.make = [=](hal::Clock& clock) -> std::unique_ptr<hal::SampleSource> {
    *device = std::make_unique<protocol::DeviceEmulator>(
        protocol::DeviceEmulator::create(two_part_eye(bus), protocol::tests::shown(12), clock.now_ns()).value());
    return std::move(
        DeviceSource::create(wanted, std::make_unique<protocol::EmulatedTransport>(**device, clock), clock).value());
  };
  test.heap_calls = [] { return compueye::tests::heap_use_of_this_thread().calls(); };
  test.lose_frames = [=](hal::SampleSource&, int frames) {
    (*device)->inject({.kind = FaultKind::lose_packets, .count = 2 * static_cast<std::uint64_t>(frames)});
  };
  test.lose_channel = [=](hal::SampleSource&, int) { (*device)->inject({.kind = FaultKind::lose_packets}); };
  test.disconnect = [=](hal::SampleSource&) { (*device)->inject({.kind = FaultKind::unplug}); };
  return test;
}

}  // namespace

TEST_CASE("an eye on USB or HID keeps the contract of sample sources") {
  for (const Bus* const bus : protocol::buses) {
    CAPTURE(bus == &hid_bus);
    DeviceSettings wanted = source_settings(bus);
    wanted.recovery_limit_ns = 0;  // the contract wants to be told at once
    check_sample_source_contract(eye_under_test(bus, wanted));
    wanted.recovery_limit_ns = 500 * ms;  // and otherwise when the time is over
    wanted.frame_rate_hz = 20.0;
    check_sample_source_contract(eye_under_test(bus, wanted));
  }
}

TEST_CASE("the contract notices when faults do not reach the eye") {
  for (const Bus* const bus : protocol::buses) {
    SourceUnderTest test = eye_under_test(bus, source_settings(bus));
    test.lose_frames = [](hal::SampleSource&, int) {};
    test.lose_channel = [](hal::SampleSource&, int) {};
    test.disconnect = [](hal::SampleSource&) {};
    CHECK(hal::tests::sample_source_violations(test).size() >= 4);
  }
}
