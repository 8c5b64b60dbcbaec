// The contract of hal::SampleSource on eyes behind the real libusb and hidapi, on a real clock.

#include "tests/hal/sample_source_contract.hpp"

#include <memory>

#include "drivers/device/device_source.hpp"
#include "tests/hil/level2/benches.hpp"
#include "tests/memory/allocation_counter.hpp"

namespace compueye::hil {
namespace {

/// Frames of two packets or reports each, the channel in the middle in the first; nothing else in the stream, so that
/// a count of packets is one of frames.
protocol::EmulatorSettings two_part_eye(const protocol::Bus* bus) {
  protocol::EmulatorSettings settings = eye("CE-1", 64, bus);
  settings.events = false;
  settings.descriptor.most_payload = 75;
  return settings;
}

template <class Port, class Transport>
void check_contract(const protocol::Bus* bus) {
  HIL_TESTBED(testbed);
  Port port(testbed, two_part_eye(bus));
  bool plugged = false;
  hal::tests::SourceUnderTest test;
  test.make = [&](hal::Clock& clock) -> std::unique_ptr<hal::SampleSource> {
    if (!plugged) port.plug();
    plugged = true;
    device::DeviceSettings settings;
    settings.bus = bus;
    settings.silence_ns = settings.start_limit_ns = patience_ns;
    settings.recovery_limit_ns = 0;  // the contract wants to be told at once
    return std::move(device::DeviceSource::create(settings, std::make_unique<Unhurried<Transport>>(), clock).value());
  };
  test.make_clock = [] { return std::make_unique<hal::MonotonicClock>(); };
  test.patience_ns = patience_ns;
  test.paced = false;
  test.heap_calls = [] { return tests::heap_use_of_this_thread().calls(); };
  test.lose_frames = [&](hal::SampleSource&, int frames) {
    port.cable.inject({.kind = protocol::FaultKind::lose_packets, .count = 2 * static_cast<std::uint64_t>(frames)});
  };
  test.lose_channel = [&](hal::SampleSource&, int) { port.cable.inject({.kind = protocol::FaultKind::lose_packets}); };
  test.disconnect = [&](hal::SampleSource&) {
    port.unplug();
    plugged = false;
  };
  hal::tests::check_sample_source_contract(test);
}

}  // namespace

TEST_CASE("usb: an eye behind libusb keeps the contract of sample sources") {
  check_contract<UsbPort, transport::UsbTransport>(&protocol::usb_bus);
}

TEST_CASE("hid: an eye behind hidapi keeps the contract of sample sources") {
  check_contract<HidPort, transport::HidTransport>(&protocol::hid_bus);
}

}  // namespace compueye::hil
