#include "drivers/device/device_settings.hpp"

#include <functional>
#include <limits>

#include "tests/drivers/device/eye_rig.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye;
using namespace compueye::device;
using namespace compueye::device::tests;
using hal::ErrorCode;
using protocol::SampleFormat;

TEST_CASE("settings out of range are named with their range") {
  struct Case {
    std::function<void(DeviceSettings&)> spoil;
    test::Named named;
  };
  const Case cases[] = {
      {[](auto& s) { s.frame_rate_hz = 0.0; }, {"0", "0.001", "4000000"}},
      {[](auto& s) { s.frame_rate_hz = std::numeric_limits<double>::quiet_NaN(); }, {"nan", "0.001", "4000000"}},
      {[](auto& s) { s.frame_rate_hz = 1e9; }, {"1000000000", "0.001", "4000000"}},
      {[](auto& s) { s.exposure_ns = -1; }, {"-1", "4294967295"}},
      {[](auto& s) { s.exposure_ns = std::int64_t{1} << 33; }, {"8589934592", "4294967295"}},
      {[](auto& s) { s.silence_ns = 10 * ms; }, {"10000000"}},
      {[](auto& s) { s.silence_ns = 9 * ms; }, {"9000000", "10000000"}},
      {[](auto& s) { s.recovery_limit_ns = -1; }, {"-1", "2000000000"}},
      {[](auto& s) { s.start_limit_ns = 0; }, {"30000000000", "0"}},
      {[](auto& s) { s.start_limit_ns = -7; }, {"30000000000", "-7"}},
      {[](auto& s) {
         s.back_off = {0, 5};
       },
       {"0", "5"}},
      {[](auto& s) {
         s.back_off = {5, 4};
       },
       {"5", "4"}},
  };
  CHECK(check_settings({}));
  for (const Case& each : cases) {
    CAPTURE(&each - cases);
    DeviceSettings settings = source_settings(&usb_bus);
    each.spoil(settings);
    const EyeRig rig(protocol::tests::eye_settings(&usb_bus), settings);
    test::check_error(rig.made(), ErrorCode::out_of_range, "eye", each.named);
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
  test::check_error(configuration_for(settings, device), ErrorCode::out_of_range, device.serial,
                    {"10", "1000", "10000000"});
  settings = {};
  settings.frame_rate_hz = 100'000.0;
  test::check_error(configuration_for(settings, device), ErrorCode::out_of_range, device.serial,
                    {"100000000", "1000", "10000000"});

  device = protocol::tests::descriptor_of(64, 18);
  settings = {};
  CHECK(configuration_for(settings, device)->format == SampleFormat::i24);
  settings.format = SampleFormat::u12;
  CHECK(configuration_for(settings, device).error().code == ErrorCode::out_of_range);
  settings = {};
  settings.bus = &protocol::hid_bus;
  CHECK(configuration_for(settings, device).error().code == ErrorCode::unsupported);
}
