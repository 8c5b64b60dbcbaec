#include "drivers/illuminator/device_light.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <set>
#include <vector>

#include "drivers/device/device_source.hpp"
#include "tests/drivers/protocol/emulated_eye.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/hal/units.hpp"

using namespace compueye;
using protocol::IlluminatorKind;

namespace {

using compueye::test::ms;

/// A device with a lamp for each pixel of 2x3, and a display between them that is none of them, over a real driver.
struct LitDevice {
  hal::VirtualClock clock{1000 * ms};
  std::vector<std::uint16_t> seen;
  std::vector<std::uint8_t> tags;
  protocol::DeviceEmulator device;
  std::unique_ptr<device::DeviceSource> eye;

  static protocol::EmulatorSettings settings(const protocol::Bus* bus) {
    protocol::EmulatorSettings settings = protocol::tests::eye_settings(bus, 4);
    settings.descriptor.serial = "CE-LIT";
    auto& lights = settings.descriptor.illuminators;
    lights.clear();
    for (std::uint8_t k = 0; k < 6; ++k) {
      lights.push_back({static_cast<std::uint8_t>(20 + k), IlluminatorKind::lamp, 11, 1, 1, (k + 1U) * 1'000'000U});
    }
    lights.insert(lights.begin() + 2, {7, IlluminatorKind::display, 256, 4, 4, 0});
    return settings;
  }
  explicit LitDevice(const protocol::Bus* bus = &protocol::usb_bus)
      : device(protocol::DeviceEmulator::create(
                   settings(bus),
                   [this](const protocol::EmulatedExposure& exposure, std::span<std::int32_t> codes) {
                     seen.assign(exposure.levels.begin(), exposure.levels.end());
                     std::fill(codes.begin(), codes.end(), 0);
                   },
                   0)
                   .value()) {
    device::DeviceSettings wanted;
    wanted.bus = bus;
    eye = device::DeviceSource::create(wanted, std::make_unique<protocol::EmulatedTransport>(device, clock), clock)
              .value();
  }

  illuminator::SetIllumination set() {
    return [this](const protocol::Illumination& wanted) {
      tags.push_back(wanted.tag);
      return eye->set_illumination(wanted);
    };
  }
  /// What the lamps give while a frame is exposed.
  const std::vector<std::uint16_t>& levels() {
    REQUIRE(eye->start().has_value());
    REQUIRE(eye->read(clock.now_ns() + 1000 * ms).has_value());
    eye->stop();
    return seen;
  }
};

}  // namespace

TEST_CASE("a device's lamps show a picture in the descriptor's order, at the nearest of their levels") {
  for (const protocol::Bus* bus : protocol::buses) {
    CAPTURE(bus->name);
    LitDevice lit(bus);
    const auto light = illuminator::DeviceLight::create(lit.device.descriptor(), 2, 3, lit.set(), lit.clock).value();
    CHECK(light->describe().levels == 11);
    CHECK(light->describe().settle_ns == 6 * ms);
    const std::vector<float> picture{0.0F, 0.5F, 1.0F, 0.26F, std::numeric_limits<float>::quiet_NaN(), 2.0F};
    const std::int64_t stable_ns = light->show(picture).value();
    CHECK(stable_ns == lit.clock.now_ns() + 6 * ms);
    CHECK(lit.levels() == std::vector<std::uint16_t>{0, 5, 0, 10, 3, 0, 10});
    REQUIRE(light->off().has_value());
    CHECK(lit.levels() == std::vector<std::uint16_t>(7, 0));
  }
}

TEST_CASE("the lamps of an eye that is not there are an error that says so") {
  LitDevice lit;
  const auto light = illuminator::DeviceLight::create(lit.device.descriptor(), 2, 3, lit.set(), lit.clock).value();
  lit.device.inject({.kind = protocol::FaultKind::unplug, .at_ns = lit.clock.now_ns()});
  test::check_error(light->off(), hal::ErrorCode::disconnected, "CE-LIT", {});
}

TEST_CASE("every picture has another tag than the one before, and none that of a light that changes") {
  LitDevice lit;
  const auto light = illuminator::DeviceLight::create(lit.device.descriptor(), 2, 3, lit.set(), lit.clock).value();
  std::set<std::uint8_t> all;
  for (int k = 0; k < 300; ++k) {
    lit.tags.clear();
    REQUIRE(light->show(std::vector<float>(6, 1.0F)).has_value());
    CHECK(std::set<std::uint8_t>(lit.tags.begin(), lit.tags.end()).size() == 1);
    CHECK((k % 255 != 0 || all.count(lit.tags.front()) == static_cast<std::size_t>(k > 0)));
    all.insert(lit.tags.front());
  }
  CHECK(all.size() == 255);
  CHECK(all.count(protocol::illumination_changing) == 0);
}

TEST_CASE("a device without a lamp for each pixel is no light, and a picture has to fit") {
  LitDevice lit;
  test::check_error(illuminator::DeviceLight::create(lit.device.descriptor(), 3, 3, lit.set(), lit.clock),
                    hal::ErrorCode::unsupported, "CE-LIT", {"6", "9"});
  const auto light = illuminator::DeviceLight::create(lit.device.descriptor(), 2, 3, lit.set(), lit.clock).value();
  test::check_error(light->show(std::vector<float>(5, 1.0F)), hal::ErrorCode::mismatch, "lamps", {"5", "6"});
}
