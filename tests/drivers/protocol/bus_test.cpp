#include "drivers/protocol/bus.hpp"

#include <doctest/doctest.h>

#include <set>
#include <string_view>
#include <vector>

#include "tests/drivers/protocol/emulated_eye.hpp"

using namespace compueye::protocol;
using namespace compueye::protocol::tests;

TEST_CASE("buses have names of their own, and reads that fit their framing") {
  std::set<std::string_view> names, titles;
  for (const Bus* const bus : buses) {
    CAPTURE(bus->name);
    CHECK(names.insert(bus->name).second);
    CHECK(titles.insert(bus->title).second);
    CHECK((bus->framing == Framing::reports) == (bus->report_bytes > 0));
    CHECK(bus->page_bytes >= DescriptorPrefix::bytes);
    CHECK(bus->page_bytes <= most_control_bytes);
    CHECK(bus->emulated_bytes_per_s > 0.0);
    CHECK(bus->most_channels >= 1);
  }
  CHECK(usb_bus.carries(SampleFormat::i24));
  CHECK(hid_bus.carries(SampleFormat::u12));
  CHECK_FALSE(hid_bus.carries(SampleFormat::u16));
}

TEST_CASE("a frame on the wire is as long as its bus says, or shorter by what its last samples leave") {
  struct Case {
    const Bus* bus;
    int channels;
    std::uint16_t most_payload;
  };
  for (const Case& c : {Case{&usb_bus, 1, 65535}, Case{&usb_bus, 64, 65535}, Case{&usb_bus, 101, 15},
                        Case{&hid_bus, 1, 65535}, Case{&hid_bus, 37, 65535}, Case{&hid_bus, 100, 65535}}) {
    CAPTURE(c.bus->name);
    CAPTURE(c.channels);
    EmulatorSettings settings = eye_settings(c.bus, c.channels);
    settings.descriptor.most_payload = c.most_payload;
    settings.events = false;
    EmulatedEye eye(settings);
    REQUIRE(eye.start());
    eye.clock.advance(eye.wanted().period_ns() * 19 / 10);  // one frame, and time for the link
    std::vector<std::byte> into(4096);
    std::size_t bytes = 0, got = 0;
    do {
      got = eye.device.read(eye.clock.now_ns(), into).bytes;
      bytes += got;
    } while (got > 0);
    REQUIRE(eye.device.truth().frames == 1);
    const FrameSize size = frame_size(*c.bus, settings.descriptor, SampleFormat::u12);
    CHECK(eye.device.truth().packets == size.packets);
    CHECK(bytes <= size.bytes);
    CHECK(bytes + 3 * size.packets > size.bytes);
  }
}
