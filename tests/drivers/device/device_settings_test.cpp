#include "drivers/device/device_settings.hpp"

#include <functional>
#include <limits>

#include "tests/drivers/device/eye_rig.hpp"

using namespace compueye;
using namespace compueye::device;
using namespace compueye::device::tests;
using hal::ErrorCode;
using protocol::SampleFormat;

TEST_CASE("settings out of range are named with their range") {
  struct Case {
    const char* word;
    std::function<void(DeviceSettings&)> spoil;
  };
  const Case cases[] = {
      {"frame rate", [](DeviceSettings& s) { s.frame_rate_hz = 0.0; }},
      {"frame rate", [](DeviceSettings& s) { s.frame_rate_hz = std::numeric_limits<double>::quiet_NaN(); }},
      {"frame rate", [](DeviceSettings& s) { s.frame_rate_hz = 1e9; }},
      {"exposure", [](DeviceSettings& s) { s.exposure_ns = -1; }},
      {"exposure", [](DeviceSettings& s) { s.exposure_ns = std::int64_t{1} << 33; }},
      {"silence", [](DeviceSettings& s) { s.silence_ns = 10 * ms; }},
      {"limits", [](DeviceSettings& s) { s.recovery_limit_ns = -1; }},
      {"limits", [](DeviceSettings& s) { s.start_limit_ns = 0; }},
      {"pauses",
       [](DeviceSettings& s) {
         s.back_off = {0, 5};
       }},
      {"pauses",
       [](DeviceSettings& s) {
         s.back_off = {5, 4};
       }},
  };
  CHECK(check_settings({}));
  for (const Case& each : cases) {
    CAPTURE(each.word);
    DeviceSettings settings = source_settings(&usb_bus);
    each.spoil(settings);
    const EyeRig rig(protocol::tests::eye_settings(&usb_bus), settings);
    REQUIRE_FALSE(rig.made());
    CHECK(rig.made().error().code == ErrorCode::out_of_range);
    CHECK(rig.made().error().sentence.find(each.word) != std::string::npos);
    CHECK(rig.made().error().sentence.find("expected") + rig.made().error().sentence.find("give") != std::string::npos);
  }
}

TEST_CASE("the configuration is what was asked for, or the device's limits are named") {
  protocol::DeviceDescriptor device = protocol::tests::descriptor_of(64, 12);
  DeviceSettings settings;
  CHECK(configuration_for(settings, device)->format == SampleFormat::u12);
  CHECK(configuration_for(settings, device)->frame_rate_mhz == 100'000);
  CHECK(configuration_for(settings, device)->exposure_ns == 10'000'000);  // the period
  settings.format = SampleFormat::u16;
  settings.exposure_ns = 2500;
  CHECK(configuration_for(settings, device)->format == SampleFormat::u16);
  CHECK(configuration_for(settings, device)->exposure_ns == 2500);
  settings.exposure_ns = 10;
  CHECK(configuration_for(settings, device).error().sentence.find("1000 to") != std::string::npos);
  settings = {};
  settings.frame_rate_hz = 100'000.0;
  CHECK(configuration_for(settings, device).error().sentence.find("frame rate") != std::string::npos);

  device = protocol::tests::descriptor_of(64, 18);
  settings = {};
  CHECK(configuration_for(settings, device)->format == SampleFormat::i24);
  settings.format = SampleFormat::u12;
  CHECK(configuration_for(settings, device).error().code == ErrorCode::out_of_range);
  settings = {};
  settings.bus = &protocol::hid_bus;
  CHECK(configuration_for(settings, device).error().code == ErrorCode::unsupported);
}
