// What `compueye doctor` finds on a machine that a test has made, and on emulated converters.

#include "firmware/doctor/doctor_check.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <string>

#include "firmware/doctor/link_quality.hpp"
#include "tests/drivers/device/converter_rig.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/source_folder.hpp"

namespace compueye::firmware {
namespace {

using device::tests::ConverterEye;
using device::tests::ConverterRig;
using frontend::FrontEndFaultKind;

bool says(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// A machine of files, a board and a clock.
struct Ward {
  explicit Ward(const std::string& name)
      : board(load_board(compueye::test::source_path("boards/" + name)).value()), examined{board, clock} {
    examined.root = folder.path().string();
  }
  void file(const std::string& path, const std::string& text) const {
    const std::filesystem::path at = folder.path() / path.substr(1);
    std::filesystem::create_directories(at.parent_path());
    std::ofstream(at) << text << '\n';
  }
  [[nodiscard]] Finding look(Finding (*check)(const Examined&)) const {
    Finding found = check(examined);
    CHECK(found.todo.empty() == (found.health == Health::good || found.health == Health::none));
    CHECK_FALSE(found.what.empty());
    return found;
  }

  compueye::test::TemporaryFolder folder;
  hal::VirtualClock clock;
  Board board;
  Examined examined;
};

}  // namespace

TEST_CASE("doctor: device files that are not there, or not for this user, are told with what to type") {
  const Ward ward("rpi4-spi-mcp3208");
  Finding found = ward.look(examine_device_files);
  CHECK(found.health == Health::bad);
  CHECK(says(found.what, "/dev/gpiochip0"));
  CHECK(says(found.todo, "dtparam=spi=on"));
  ward.file("/dev/gpiochip0", "");
  found = ward.look(examine_device_files);
  CHECK(says(found.what, "/dev/spidev0.0"));
  ward.file("/dev/spidev0.0", "");
  found = ward.look(examine_device_files);
  CHECK(found.health == Health::good);
  CHECK(says(found.what, "/dev/gpiochip0, /dev/spidev0.0"));
  CHECK(Ward("generic-usb").look(examine_device_files).health == Health::none);
}

TEST_CASE("doctor: a udev rule is one that names vendor and product") {
  const Ward ward("generic-usb");
  CHECK(ward.look(examine_udev_rule).health == Health::note);
  ward.file("/etc/udev/rules.d/70-other.rules", "ATTR{idVendor}==\"1209\", ATTR{idProduct}==\"0002\"");
  CHECK(ward.look(examine_udev_rule).health == Health::note);
  ward.file("/etc/udev/rules.d/71-eye.rules", "ATTR{idVendor}==\"1209\", ATTR{idProduct}==\"0001\"");
  const Finding found = ward.look(examine_udev_rule);
  CHECK(found.health == Health::good);
  CHECK(says(found.what, "/etc/udev/rules.d/71-eye.rules names 1209:0001"));
}

TEST_CASE("doctor: what the kernel moves in a call is held against a frame, and usbfs against transfers in flight") {
  const Ward spi("rpi5-spi-ddc264");
  CHECK(spi.look(examine_bufsiz).health == Health::note);
  spi.file("/sys/module/spidev/parameters/bufsiz", "4096");
  CHECK(spi.look(examine_bufsiz).health == Health::good);
  spi.file("/sys/module/spidev/parameters/bufsiz", "128");
  const Finding cut = spi.look(examine_bufsiz);
  CHECK(cut.health == Health::note);
  CHECK(says(cut.todo, "spidev.bufsiz=4096"));

  const Ward usb("generic-usb");
  CHECK(usb.look(examine_usbfs).health == Health::none);
  usb.file("/sys/module/usbcore/parameters/usbfs_memory_mb", "8");
  CHECK(usb.look(examine_usbfs).health == Health::bad);
  usb.file("/sys/module/usbcore/parameters/usbfs_memory_mb", "16");
  CHECK(usb.look(examine_usbfs).health == Health::good);
  usb.file("/sys/module/usbcore/parameters/usbfs_memory_mb", "0");
  CHECK(says(usb.look(examine_usbfs).what, "without end"));
}

TEST_CASE("doctor: governor, heat, supply, limits, clock and kernel") {
  Ward ward("sim-8x8");
  CHECK(ward.look(examine_governor).health == Health::none);
  ward.file("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "performance");
  CHECK(ward.look(examine_governor).health == Health::good);
  ward.file("/sys/devices/system/cpu/cpu1/cpufreq/scaling_governor", "ondemand");
  CHECK(says(ward.look(examine_governor).what, "1 of 2 processors have 'ondemand'"));

  CHECK(ward.look(examine_throttling).health == Health::none);
  ward.file("/sys/class/thermal/thermal_zone0/temp", "45123");
  CHECK(ward.look(examine_throttling).what == "45 degrees");
  ward.file("/sys/class/thermal/thermal_zone1/temp", "81000");
  CHECK(ward.look(examine_throttling).health == Health::note);
  const std::string throttled = "/sys/devices/platform/soc/soc:firmware/get_throttled";
  ward.file(throttled, "0x50005");
  CHECK(says(ward.look(examine_throttling).what, "voltage"));
  ward.file(throttled, "0x4");
  CHECK(says(ward.look(examine_throttling).what, "hot"));
  CHECK(ward.look(examine_throttling).health == Health::bad);

  ward.examined.limits = {0, 8U << 20U};
  CHECK(ward.look(examine_realtime).health == Health::note);
  CHECK(says(ward.look(examine_locking).what, "8 MiB"));
  ward.examined.limits = {95, std::numeric_limits<std::uint64_t>::max()};
  CHECK(ward.look(examine_realtime).health == Health::good);
  CHECK(ward.look(examine_locking).health == Health::good);

  const std::string source = "/sys/devices/system/clocksource/clocksource0/current_clocksource";
  CHECK(ward.look(examine_clock_source).health == Health::none);
  struct Source {
    const char* name;
    Health health;
  };
  for (const Source& each :
       {Source{"jiffies", Health::bad}, Source{"hpet", Health::note}, Source{"arch_sys_counter", Health::good}}) {
    ward.file(source, each.name);
    CHECK(ward.look(examine_clock_source).health == each.health);
  }
  CHECK(ward.look(examine_kernel).health == Health::note);
  ward.file("/sys/kernel/realtime", "1");
  CHECK(ward.look(examine_kernel).health == Health::good);
}

TEST_CASE("doctor: an eye that answers is good, and a link is as good as its frames come") {
  Ward ward("rpi5-spi-ddc264");
  const ConverterEye eye = device::tests::converter_eyes[3];
  hal::VirtualClock clock;
  frontend::EmulatedFrontEnd chips(device::tests::emulated(eye), clock.now_ns());
  Examined examined{ward.board, clock};
  examined.frames = 300;
  examined.eye = [&]() -> hal::Result<std::unique_ptr<hal::SampleSource>> {
    auto made =
        device::ConverterSource::create(device::tests::source_of(chips), device::tests::wires_of(chips, clock), clock);
    if (!made) return tl::unexpected(made.error());
    return std::unique_ptr<hal::SampleSource>(std::move(*made));
  };
  CHECK(says(examine_eye(examined).what, "64 channels of 20 bits"));
  const Finding good = examine_link(examined);
  CHECK(good.health == Health::good);
  CHECK(says(good.what, "300 frames, 0 lost"));

  chips.inject({.kind = FrontEndFaultKind::edges_missed, .at_ns = clock.now_ns() + 50'000'000, .count = 4});
  const Finding lossy = examine_link(examined);
  CHECK(lossy.health == Health::bad);
  CHECK_MESSAGE(says(lossy.what, "300 frames, 4 lost (missed_edge 4)"), lossy.what);

  chips.inject({.kind = FrontEndFaultKind::slow_bus, .at_ns = clock.now_ns(), .count = 50, .value = 700'000});
  const Finding late = examine_link(examined);
  CHECK_MESSAGE(late.health == Health::note, late.what);

  ward.board.sensor.bits = 16;  // another board's eye
  CHECK(examine_eye(examined).health == Health::bad);
  chips.inject({.kind = FrontEndFaultKind::gone});
  CHECK(examine_eye(examined).health == Health::bad);
  CHECK(examine_link(examined).health == Health::none);
}

TEST_CASE("doctor: percentiles are nearest ranks, and a histogram has every frame once") {
  std::vector<double> values;
  for (int k = 1; k <= 1000; ++k) values.push_back(0.01 * k);
  CHECK(percentile(values, 0.5) == doctest::Approx(5.0));
  CHECK(percentile(values, 0.999) == doctest::Approx(9.99));
  CHECK(percentile(values, 1.0) == doctest::Approx(10.0));
  CHECK(percentile({}, 0.5) == 0.0);
  const std::string text = histogram(values);
  CHECK(says(text, "below       1 us     99 "));
  CHECK(says(text, "below       2 us    100 "));
  CHECK(says(text, "below       5 us    300 "));
  CHECK(says(text, "below      10 us    500 "));
  CHECK(says(text, "below      20 us      1 "));
}

TEST_CASE("doctor: its page names every check") {
  const std::string page = compueye::test::bytes_of(compueye::test::source_path("docs/doctor.md"));
  CHECK_MESSAGE(says(page, doctor_reference()), "docs/doctor.md should hold:\n" << doctor_reference());
}

}  // namespace compueye::firmware
