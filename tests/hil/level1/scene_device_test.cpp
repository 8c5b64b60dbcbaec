// An eye on an emulated cable and a simulated eye see one and the same scene.

#include "sim/scene_device.hpp"

#include <doctest/doctest.h>

#include <memory>
#include <vector>

#include "drivers/device/device_source.hpp"
#include "drivers/protocol/emulated_transport.hpp"
#include "hal/clock.hpp"
#include "sim/pictures/built_in_scenes.hpp"
#include "sim/simulated_eye.hpp"
#include "tests/hal/units.hpp"

using namespace compueye;

namespace {

using compueye::test::second;

sim::SimulatedEyeSettings moving_eye(int bits) {
  sim::SimulatedEyeSettings settings;
  settings.board.eye.interommatidial_rad = 0.03;
  settings.board.eye.acceptance_rad = 0.14;
  settings.board.sensor = {.bits = bits, .full_scale = 128.0, .read_noise_lsb = 1.5, .dark_level_lsb = 20.0};
  settings.board.frame_rate_hz = 100.0;
  sim::Scene scene = sim::scene_on(settings.board.object, "dots", sim::render_built_in("dots", 32, 32, 3).value());
  scene.surfaces[0].motion.velocity_mm_per_s = {20.0, 0.0, 0.0};
  settings.scenes = {scene};
  settings.seed = 5;
  return settings;
}

std::vector<std::int32_t> next(hal::SampleSource& source, hal::Clock& clock, std::uint64_t frame) {
  for (;;) {
    const auto block = source.read(clock.now_ns() + second);
    if (!block && block.error().code == hal::ErrorCode::timeout) continue;
    REQUIRE(block);
    REQUIRE(block->frame == frame);
    return {block->codes.begin(), block->codes.end()};
  }
}

}  // namespace

TEST_CASE("an emulated device plays a scene with the very codes of the simulated eye, on USB and HID") {
  for (const protocol::Bus* bus : {&protocol::usb_bus, &protocol::hid_bus}) {
    for (const int bits : {12, 16}) {
      if (bus->framing == protocol::Framing::reports && bits > 12) continue;  // more than a report carries
      CAPTURE(bus->name);
      CAPTURE(bits);
      const sim::SimulatedEyeSettings settings = moving_eye(bits);
      hal::VirtualClock clock(second);
      auto simulated = sim::SimulatedEye::create(settings, clock).value();
      auto played = std::make_shared<sim::Simulation>(
          sim::Simulation::create(settings.board, settings.scenes[0], settings.seed).value());
      protocol::EmulatorSettings device_settings;
      device_settings.bus = bus;
      device_settings.descriptor = sim::describe_device(settings.board, "SCENE-1");
      auto device = protocol::DeviceEmulator::create(device_settings, sim::samples_of(played), clock.now_ns()).value();
      device::DeviceSettings source_settings;
      source_settings.bus = bus;
      source_settings.frame_rate_hz = settings.board.frame_rate_hz;
      auto source = device::DeviceSource::create(std::move(source_settings),
                                                 std::make_unique<protocol::EmulatedTransport>(device, clock), clock);
      REQUIRE(source);
      CHECK((*source)->describe().channels == settings.board.eye.ommatidia());
      REQUIRE((*source)->start());
      REQUIRE(simulated->start());
      std::vector<std::int32_t> first;
      for (std::uint64_t frame = 0; frame < 5; ++frame) {
        const auto on_cable = next(**source, clock, frame);
        CHECK(on_cable == next(*simulated, clock, frame));
        if (frame == 0) first = on_cable;
        CHECK((on_cable == first) == (frame == 0));
      }
    }
  }
}
