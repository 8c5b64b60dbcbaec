// The USB transport between its threads: one reads, one asks, libusb's own and the transport's, and the device's.

#include <doctest/doctest.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <functional>
#include <optional>
#include <thread>
#include <vector>

#include "drivers/transport/usb_libusb.hpp"
#include "hal/clock.hpp"
#include "tests/drivers/protocol/wire_samples.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/hal/no_threads.hpp"
#include "tests/hal/units.hpp"
#include "tests/hil/level2/testbed.hpp"
#include "tests/hil/usbfs_shim.hpp"

namespace compueye::hil {
namespace {

protocol::EmulatorSettings busy_eye() {
  protocol::EmulatorSettings settings;
  settings.descriptor = protocol::tests::descriptor_of(200, 12);
  settings.fifo_bytes = std::size_t{1} << 20U;
  settings.boot_ns = 0;
  return settings;
}

/// An eye behind the shim; a thread makes its data ready as time passes.
class ShimmedEye {
 public:
  ShimmedEye()
      : cable(busy_eye()), eye_(cable), file(eye_), host(transport, clock, &protocol::usb_bus, busy_eye().descriptor) {
    entry.serial = cable.serial();
    shim_usbfs(entry.device_file(), file);
    testbed_.add(entry.text());
    ticker_ = std::thread([this] {
      while (!stopping_) {
        refresh_shim();
        std::this_thread::sleep_for(std::chrono::microseconds(300));
      }
    });
    host.frame_rate_mhz = 800'000;
    host.request_ns = host.frame_ns = 60'000'000'000;  // what has to come is waited for
  }
  ~ShimmedEye() {
    transport.close();
    stopping_ = true;
    ticker_.join();
  }
  ShimmedEye(const ShimmedEye&) = delete;
  ShimmedEye& operator=(const ShimmedEye&) = delete;
  void at_reset(std::function<void()> what) { eye_.at_reset = std::move(what); }
  [[nodiscard]] std::int64_t in_ms(std::int64_t duration) const { return clock.now_ns() + duration * test::ms; }

 private:
  Testbed testbed_;

 public:
  UsbEntry entry;
  EmulatedCable cable;

 private:
  EmulatedUsbEye eye_;

 public:
  EmulatedUsbfs file;
  hal::MonotonicClock clock;
  transport::UsbTransport transport;
  protocol::tests::SmallHost host;

 private:
  std::atomic<bool> stopping_ = false;
  std::thread ticker_;
};

#define SKIP_WITHOUT_UMOCKDEV()                            \
  if (const auto why = Testbed::missing(); !why.empty()) { \
    MESSAGE("SKIPPED: " << why);                           \
    return;                                                \
  }

TEST_CASE("an eye that gets no thread is an error, at the start and at a re-plug, and is read when there is one") {
  SKIP_WITHOUT_UMOCKDEV();
  ShimmedEye eye;
  REQUIRE(eye.host.start());
  for (int plug = 0; plug < 2; ++plug) {
    REQUIRE(eye.host.frame());
    eye.transport.close();
    // libusb has its own thread by then, the transport has yet to make one.
    std::optional<compueye::test::NoThreads> refused;
    eye.at_reset([&] { refused.emplace(); });
    const auto opened = eye.transport.open();
    REQUIRE(refused);
    refused.reset();
    eye.at_reset(nullptr);
    compueye::test::check_error(opened, hal::ErrorCode::no_space, "usb 1-4 (CE-1)", {});
    REQUIRE(eye.host.start());
  }
}

TEST_CASE("one thread reads every frame while another asks") {
  SKIP_WITHOUT_UMOCKDEV();
  ShimmedEye eye;
  REQUIRE(eye.host.start());
  std::atomic<bool> stop = false;
  std::uint64_t answers = 0, refusals = 0;
  std::thread asking([&] {
    while (!stop) {
      const auto status = eye.host.status();
      (status ? answers : refusals) += 1;
    }
  });
  std::uint64_t right = 0;
  for (std::uint64_t k = 0; k < 1000; ++k) {
    const auto block = eye.host.frame();
    if (!block) break;
    right += block->frame == k && eye.host.right(*block, k) ? 1 : 0;
  }
  stop = true;
  asking.join();
  CHECK(right == 1000);
  CHECK(eye.host.account().total_dropped() == 0);
  CHECK(answers > 10);
  CHECK(refusals == 0);
}

TEST_CASE("RESET_PIPES under a reading thread loses no transfer") {
  SKIP_WITHOUT_UMOCKDEV();
  ShimmedEye eye;
  REQUIRE(eye.host.start());
  std::atomic<bool> stop = false;
  std::atomic<std::uint64_t> bytes = 0;
  std::uint64_t others = 0;
  std::thread reading([&] {
    std::vector<std::byte> chunk(16384);
    while (!stop) {
      const auto got = eye.transport.read(chunk, eye.in_ms(20));
      if (got) bytes += *got;
      if (!got && got.error().code != hal::ErrorCode::timeout) ++others;
    }
  });
  for (int k = 0; k < 25; ++k) {
    REQUIRE(eye.host.request(protocol::Request::reset_pipes));
    REQUIRE(eye.host.request(protocol::Request::start));
    for (const std::uint64_t before = bytes; bytes == before;) std::this_thread::yield();
  }
  stop = true;
  reading.join();
  CHECK(bytes > 0);
  CHECK(others == 0);
  CHECK(eye.transport.counters().restarts == 26);
  eye.transport.close();
  CHECK(eye.file.waiting() == 0);
  CHECK(eye.file.counters().submitted == eye.file.counters().reaped);
}

TEST_CASE("a pulled plug ends reading and asking, and closing ends everything") {
  SKIP_WITHOUT_UMOCKDEV();
  ShimmedEye eye;
  REQUIRE(eye.host.start());
  hal::ErrorCode asked = hal::ErrorCode::usage, read = hal::ErrorCode::usage;
  const auto give_up = eye.in_ms(60'000);
  std::thread asking([&] {
    while (asked != hal::ErrorCode::disconnected && eye.clock.now_ns() < give_up) {
      const auto status = eye.host.status();
      if (!status) asked = status.error().code;
    }
  });
  std::thread reading([&] {
    std::vector<std::byte> chunk(16384);
    while (read != hal::ErrorCode::disconnected && eye.clock.now_ns() < give_up) {
      const auto got = eye.transport.read(chunk, eye.in_ms(100));
      if (!got) read = got.error().code;
    }
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  eye.cable.replace("CE-1");
  asking.join();
  reading.join();
  CHECK(asked == hal::ErrorCode::disconnected);
  CHECK(read == hal::ErrorCode::disconnected);
  eye.transport.close();
  CHECK(eye.file.waiting() == 0);
}

TEST_CASE("an eye that may not be opened is listed with its serial, and the refusal names the udev rule") {
  SKIP_WITHOUT_UMOCKDEV();
  ShimmedEye eye;
  refuse_to_open(EACCES);
  const auto eyes = transport::list_usb_eyes();
  REQUIRE(eyes);
  REQUIRE(eyes->size() == 1);
  CHECK(eyes->at(0).serial == eye.cable.serial());
  CHECK_FALSE(eyes->at(0).reachable());
  transport::UsbSettings settings;
  settings.serial = eye.cable.serial();
  transport::UsbTransport refused(settings);
  test::check_error(refused.open(), hal::ErrorCode::io, eyes->at(0).bus,
                    {eyes->at(0).path, "boards/60-compueye.rules"});
  settings.serial = "OTHER";
  transport::UsbTransport absent(settings);
  CHECK(absent.open().error().code == hal::ErrorCode::not_found);
  refuse_to_open(0);
  CHECK(refused.open());
}

TEST_CASE("an eye whose control endpoint hangs is found by its noted serial, and opening it resets it") {
  SKIP_WITHOUT_UMOCKDEV();
  ShimmedEye eye;
  eye.cable.inject({.kind = protocol::FaultKind::control_silence, .duration_ns = 0});
  REQUIRE(eye.host.start());
  CHECK(eye.transport.describe().serial == eye.cable.serial());
  CHECK(eye.host.frame());
}

}  // namespace
}  // namespace compueye::hil
