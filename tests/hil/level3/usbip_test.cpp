// The far end of a USB/IP connection, before a host that is this test: what vhci-hcd asks of an eye.

#include <doctest/doctest.h>
#include <linux/hid.h>
#include <linux/usb/ch9.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <string>
#include <vector>

#include "drivers/protocol/hid_report.hpp"
#include "tests/drivers/protocol/wire_samples.hpp"
#include "tests/hil/level3/driven_lines.hpp"
#include "tests/hil/level3/emulated_hid_eye.hpp"
#include "tests/hil/level3/usbip_device.hpp"

namespace compueye::hil {
namespace {

using Words = std::array<std::uint32_t, usbip_header_bytes / 4>;

UsbipHeader header_of(const Words& words) {
  UsbipHeader header{};
  for (std::size_t k = 0; k < header.size(); ++k) {
    header[k] = static_cast<std::byte>(words[k / 4] >> (24U - 8U * (k % 4)) & 0xFFU);
  }
  return header;
}

Words words_of(const UsbipHeader& header) {
  Words words{};
  for (std::size_t k = 0; k < header.size(); ++k)
    words[k / 4] = words[k / 4] << 8U | std::to_integer<unsigned>(header[k]);
  return words;
}

struct Answer {
  Words header{};
  std::vector<std::uint8_t> data;
  [[nodiscard]] int status() const { return static_cast<int>(header[5]); }
};

std::array<int, 2> socket_pair() {
  std::array<int, 2> ends{};
  REQUIRE(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()) == 0);
  return ends;
}

/// A HID eye and the host's end of its cable.
struct Bench {
  Bench() = default;
  ~Bench() {
    ::close(ends[0]);
    ::close(ends[1]);
  }
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;

  static protocol::EmulatorSettings settings() {
    protocol::EmulatorSettings made;
    made.bus = &protocol::hid_bus;
    made.descriptor = protocol::tests::descriptor_of(64, 12);
    made.descriptor.serial = "CE-7";
    made.boot_ns = 0;
    return made;
  }
  void ask(const Words& words) {
    const UsbipHeader header = header_of(words);
    REQUIRE(::send(ends[1], header.data(), header.size(), 0) == static_cast<ssize_t>(header.size()));
  }
  void ask_control(std::array<std::uint32_t, 2> setup, std::uint32_t bytes) {
    ask({1, ++number, 0, 1, 0, 0, bytes, 0, 0, 0, setup[0], setup[1]});
  }
  Answer answer() {
    UsbipHeader header{};
    REQUIRE(::recv(ends[1], header.data(), header.size(), MSG_DONTWAIT) == static_cast<ssize_t>(header.size()));
    Answer got{words_of(header), {}};
    if (got.header[0] == 3) got.data.resize(got.header[6]);
    if (!got.data.empty()) {
      REQUIRE(::recv(ends[1], got.data.data(), got.data.size(), MSG_DONTWAIT) == static_cast<ssize_t>(got.data.size()));
    }
    return got;
  }
  [[nodiscard]] bool silent() {
    char byte = 0;
    return ::recv(ends[1], &byte, 1, MSG_DONTWAIT | MSG_PEEK) < 0 && errno == EAGAIN;
  }

  EmulatedCable cable{settings()};
  EmulatedHidEye eye{cable};
  std::array<int, 2> ends = socket_pair();
  UsbipDevice device{eye, hid_descriptors(0x1209, 0x0002), ends[0]};
  std::uint32_t number = 100;
};

// Setup packets as two words: type, request, value, index and length, the last three little-endian.
constexpr std::array<std::uint32_t, 2> get_device{0x80060001, 0x00001200}, get_serial{0x80060303, 0x0904FF00},
    get_report_descriptor{0x81060022, 0x0000FF00}, set_configuration{0x00090100, 0},
    get_interface_report{0xA1010103, 0x00004000};

}  // namespace

TEST_CASE("usbip: a captured request is read as the kernel's documentation reads it") {
  // Documentation/usb/usbip_protocol.rst, "CmdIntrIN".
  const Words captured{1, 0xD05, 0x1000F, 1, 1, 0x200, 0x40, 0xFFFFFFFF, 0, 4, 0, 0};
  const auto request = parse_usbip(header_of(captured));
  REQUIRE(request);
  CHECK(request->command == UsbipCommand::submit);
  CHECK(request->number == 0xD05);
  CHECK(request->in);
  CHECK(request->endpoint == 1);
  CHECK(request->length == 64);
  const Words answered = words_of(usbip_submitted(*request, -EPIPE, 0));
  CHECK(answered == Words{3, 0xD05, 0, 0, 0, 0xFFFFFFE0, 0, 0, 0, 0, 0, 0});
  CHECK_FALSE(parse_usbip(header_of({9, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0})));
  CHECK_FALSE(parse_usbip(header_of({1, 1, 0, 1, 1, 0, 0x80000000, 0, 0, 0, 0, 0})));
}

TEST_CASE("usbip: a HID eye describes itself, and refuses what it does not have") {
  Bench bench;
  bench.ask_control(get_device, 18);
  bench.ask_control(get_serial, 255);
  bench.ask_control(get_report_descriptor, 255);
  bench.ask_control(set_configuration, 0);
  bench.ask_control(get_interface_report, 64);  // an input report is not to be asked for
  REQUIRE(bench.device.serve(0));
  const Answer device = bench.answer(), serial = bench.answer(), report = bench.answer();
  CHECK(device.header[1] == 101);
  REQUIRE(device.data.size() == 18);
  CHECK(device.data[8] == 0x09);
  CHECK(device.data[9] == 0x12);
  CHECK(serial.data == std::vector<std::uint8_t>{10, 3, 'C', 0, 'E', 0, '-', 0, '7', 0});
  CHECK(report.data ==
        std::vector<std::uint8_t>(protocol::hid_report_descriptor.begin(), protocol::hid_report_descriptor.end()));
  CHECK(bench.answer().status() == 0);
  CHECK(bench.answer().status() == -EPIPE);
  CHECK(bench.silent());
}

TEST_CASE("usbip: what waits for data waits until it is unlinked, and a pulled eye ends the connection") {
  Bench bench;
  bench.ask({1, 7, 0, 1, 1, 0, 64, 0, 0, 4, 0, 0});
  REQUIRE(bench.device.serve(0));
  CHECK(bench.device.waiting() == 1);
  CHECK(bench.silent());
  bench.ask({2, 8, 0, 0, 0, 7, 0, 0, 0, 0, 0, 0});
  bench.ask({2, 9, 0, 0, 0, 7, 0, 0, 0, 0, 0, 0});
  REQUIRE(bench.device.serve(0));
  const Answer ended = bench.answer(), late = bench.answer();
  CHECK(ended.header[0] == 4);
  CHECK(ended.header[1] == 8);
  CHECK(ended.status() == -ECONNRESET);
  CHECK(late.status() == 0);
  bench.ask({1, 10, 0, 1, 1, 0, 64, 0, 0, 4, 0, 0});
  REQUIRE(bench.device.serve(0));
  bench.cable.replace("CE-7");
  CHECK_FALSE(bench.device.serve(0));
}

TEST_CASE("driven lines: the number is that of one chip's outputs, in the order that is asked for") {
  const std::string told =
      "gpiochip1: GPIOs 496-503, parent: platform/other, other:\n gpio-496 (                    |x   ) out hi \n\n"
      "gpiochip0: GPIOs 504-511, parent: amba/9030000.pl061, 9030000.pl061:\n"
      " gpio-504 (                    |compueye            ) out hi \n"
      " gpio-505 (                    |compueye            ) out lo \n"
      " gpio-506 (                    |compueye            ) out hi \n"
      " gpio-507 (                    |GPIO Key Poweroff   ) in  hi IRQ \n";
  const std::vector<std::string> lines{"0", "1", "2"}, turned{"1", "2"}, input{"3"};
  CHECK(driven_number(told, "gpiochip0", lines) == 0b101U);
  CHECK(driven_number(told, "gpiochip0", turned) == 0b10U);
  CHECK(driven_number(told, "gpiochip0", input) == 0U);
  CHECK(driven_number(told, "gpiochip1", lines) == 0b1U);
  CHECK(driven_number("", "gpiochip0", lines) == 0U);
}

}  // namespace compueye::hil
