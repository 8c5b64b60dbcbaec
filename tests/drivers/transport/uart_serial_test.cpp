#include "drivers/transport/uart_serial.hpp"

#include <doctest/doctest.h>
#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include "drivers/device/conformance.hpp"
#include "drivers/device/stream_promises.hpp"
#include "drivers/protocol/crc32c.hpp"
#include "drivers/protocol/little_endian.hpp"
#include "tests/drivers/protocol/emulated_eye.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye;
using namespace compueye::protocol;
using compueye::protocol::tests::eye_settings;
using compueye::protocol::tests::shown;
using compueye::protocol::tests::SmallHost;
using compueye::transport::UartTransport;

namespace {

constexpr std::int64_t long_enough_ns = 60'000'000'000;

/// What its time is.
enum class Pace : std::uint8_t {
  asked,  ///< a millisecond a request, and behind a START half a second at once
  real,   ///< the host's
};

/// The firmware of an eye at the other end of a socket: it answers what it is asked, and streams.
class Firmware {
 public:
  explicit Firmware(bool noisy = false, Pace pace = Pace::asked)
      : noisy_(noisy),
        pace_(pace),
        now_ns_(pace == Pace::real ? clock_.now_ns() : 10'000'000'000),
        device_(DeviceEmulator::create(eye_settings(&usb_bus), shown(12), now_ns_).value()) {
    int ends[2] = {-1, -1};
    REQUIRE(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) == 0);
    file_ = ends[0];
    host_ = ends[1];
    thread_ = std::thread([this] { serve(); });
  }
  Firmware(const Firmware&) = delete;
  Firmware& operator=(const Firmware&) = delete;
  ~Firmware() {
    ::shutdown(file_, SHUT_RDWR);
    thread_.join();
    ::close(file_);
  }
  /// The host's end, which is its own to close.
  [[nodiscard]] int host() const noexcept { return host_; }
  void hang_up() const noexcept { ::shutdown(file_, SHUT_RDWR); }

 private:
  void serve() {
    std::vector<std::byte> chunk(4096);
    CobsDecoder decoder(4096);
    for (;;) {
      if (pace_ == Pace::real) {
        pollfd waiting{file_, POLLIN, 0};
        const int asked = ::poll(&waiting, 1, 1);
        now_ns_ = clock_.now_ns();
        send_frames();
        if (asked == 0) continue;
      }
      const ssize_t got = ::read(file_, chunk.data(), chunk.size());
      if (got <= 0) return;
      decoder.feed(std::span<const std::byte>(chunk).first(static_cast<std::size_t>(got)));
      while (const auto frame = decoder.next()) answer(*frame);
    }
  }

  void answer(std::span<const std::byte> frame) {
    if (frame.size() < 5) return;
    const auto covered = frame.first(frame.size() - 4);
    if (crc32c(covered) != load_little<std::uint32_t>(frame.data() + covered.size())) return;
    const auto what = std::to_integer<std::uint8_t>(covered[0]);
    const std::size_t room = what == number(Request::get_desc)     ? 4096
                             : what == number(Request::get_config) ? Configuration::bytes
                             : what == number(Request::status)     ? Status::bytes
                             : what == number(Request::ping)       ? PingReply::bytes
                                                                   : 0;
    std::vector<std::byte> data(room);
    now_ns_ = pace_ == Pace::real ? clock_.now_ns() : now_ns_ + 1'000'000;
    const auto done = device_.control(now_ns_, what, covered.subspan(1), data);
    const bool taken = done.outcome == DeviceEmulator::Outcome::done;
    // Its stream is faster than its answers.
    if (taken && what == number(Request::start) && pace_ == Pace::asked) {
      now_ns_ += 500'000'000;
      send_frames();
    }
    std::vector<std::byte> reply{static_cast<std::byte>(what), taken ? std::byte{0} : std::byte{3}};
    if (taken && room > 0) {
      reply.insert(reply.end(), data.begin(), data.begin() + static_cast<std::ptrdiff_t>(done.bytes));
    }
    if (noisy_) send({std::byte{0x11}, std::byte{0}, std::byte{0x22}, std::byte{0}});
    send_frame(reply, true);
  }

  void send_frames() {
    std::vector<std::byte> bytes(1U << 20U);
    bytes.resize(device_.read(now_ns_, bytes).bytes);
    PacketStream packets(device_.descriptor().packet_limits());
    packets.feed(bytes);
    std::size_t at = 0;
    while (const auto packet = packets.next()) {
      const std::size_t length = packet->header.packet_bytes();
      send_frame(
          {bytes.begin() + static_cast<std::ptrdiff_t>(at), bytes.begin() + static_cast<std::ptrdiff_t>(at + length)},
          false);
      at += length;
    }
  }

  void send_frame(std::vector<std::byte> frame, bool sealed) {
    if (sealed) {
      std::byte crc[4];
      store_little(crc, crc32c(frame));
      frame.insert(frame.end(), crc, crc + 4);
    }
    std::vector<std::byte> encoded(cobs_bytes(frame.size()));
    encoded.resize(cobs_encode(frame, encoded));
    encoded.push_back(std::byte{0});
    send(encoded);
  }

  void send(const std::vector<std::byte>& bytes) const {
    for (std::size_t at = 0; at < bytes.size();) {
      const ssize_t put = ::send(file_, bytes.data() + at, bytes.size() - at, MSG_NOSIGNAL);
      if (put <= 0) return;
      at += static_cast<std::size_t>(put);
    }
  }

  bool noisy_;
  Pace pace_;
  hal::MonotonicClock clock_;
  std::int64_t now_ns_;
  DeviceEmulator device_;
  int file_ = -1, host_ = -1;
  std::thread thread_;
};

/// Gives every answer and every awaited frame a minute more, so that no verdict hangs on how fast the machine is.
/// Short waits stay: they are for silence.
class Patient final : public hal::ByteTransport {
 public:
  explicit Patient(hal::ByteTransport& under) : under_(under) {}
  [[nodiscard]] const hal::TransportDescription& describe() const noexcept override { return under_.describe(); }
  [[nodiscard]] hal::Result<void> open() override { return under_.open(); }
  void close() noexcept override { under_.close(); }
  [[nodiscard]] hal::Result<std::size_t> read(std::span<std::byte> into, std::int64_t deadline_ns) override {
    const bool silence = deadline_ns - clock_.now_ns() < 500'000'000;
    return under_.read(into, silence ? deadline_ns : deadline_ns + long_enough_ns);
  }
  [[nodiscard]] hal::Result<std::size_t> control(std::uint8_t request, std::span<const std::byte> payload,
                                                 std::span<std::byte> reply, std::int64_t deadline_ns) override {
    return under_.control(request, payload, reply, deadline_ns + long_enough_ns);
  }

 private:
  hal::ByteTransport& under_;
  hal::MonotonicClock clock_;
};

}  // namespace

TEST_CASE("an eye on a UART is asked and streams, its packets kept while answers are waited for") {
  for (const bool noisy : {false, true}) {
    CAPTURE(noisy);
    const Firmware firmware(noisy);
    UartTransport transport(firmware.host(), "socket");
    hal::MonotonicClock clock;
    const DeviceDescriptor expected = eye_settings(&usb_bus).descriptor;
    SmallHost host(transport, clock, &uart_bus, expected);
    host.request_ns = host.frame_ns = long_enough_ns;
    REQUIRE(transport.open());
    CHECK(host.identify().value() == expected);
    REQUIRE(host.start());
    for (std::uint64_t frame = 0; frame < 40; ++frame) {
      if (frame % 10 == 0) CHECK(host.status().value().state == DeviceState::streaming);
      const auto block = host.frame();
      REQUIRE(block.has_value());
      CHECK(block->frame == frame);
      CHECK(host.right(*block, frame));
    }
    test::check_error(host.request(Request::start), hal::ErrorCode::io, "socket", {"3"});
  }
}

TEST_CASE("what a UART streams keeps the promises of the page") {
  const Firmware firmware;
  UartTransport transport(firmware.host(), "socket");
  hal::MonotonicClock clock;
  const DeviceDescriptor eye = eye_settings(&usb_bus).descriptor;
  SmallHost host(transport, clock, &uart_bus, eye);
  host.request_ns = long_enough_ns;
  const Configuration wanted = host.wanted();
  REQUIRE(host.start());
  device::StreamPromises stream(uart_bus, eye, wanted);
  std::vector<std::byte> chunk(100);  // cuts packets anywhere
  while (stream.frames() < 40) {
    const auto got = transport.read(chunk, clock.now_ns() + long_enough_ns);
    REQUIRE(got.has_value());
    stream.feed(std::span<const std::byte>(chunk).first(*got));
  }
  CHECK(stream.broken().empty());
}

TEST_CASE("an eye on a UART that keeps every promise is found to by a whole run of conformance") {
  const Firmware firmware(false, Pace::real);
  UartTransport port(firmware.host(), "socket");
  Patient transport(port);
  hal::MonotonicClock clock;
  const auto rows = device::check_conformance(transport, clock, uart_bus);
  REQUIRE_MESSAGE(rows.has_value(), rows.error().text());
  CHECK(rows->size() > 10);
  for (const device::ConformanceRow& row : *rows) {
    CAPTURE(row.name);
    CAPTURE(row.why);
    CHECK(row.verdict != device::ConformanceRow::Verdict::fail);
  }
}

TEST_CASE("an eye that hangs up is gone, one that says nothing is waited for until the deadline") {
  const Firmware firmware;
  UartTransport transport(firmware.host(), "socket");
  REQUIRE(transport.open());
  std::vector<std::byte> chunk(100);
  CHECK(transport.read(chunk, 0).error().code == hal::ErrorCode::timeout);
  firmware.hang_up();
  hal::MonotonicClock clock;
  CHECK(transport.read(chunk, clock.now_ns() + long_enough_ns).error().code == hal::ErrorCode::disconnected);
  CHECK(transport
            .control(number(Request::ping), std::span(chunk).first(4), std::span(chunk).first(8),
                     clock.now_ns() + long_enough_ns)
            .error()
            .code == hal::ErrorCode::disconnected);
}

TEST_CASE("a port that is none, or has no such rate, is refused by name") {
  UartTransport missing("/nowhere/tty", 115'200);
  test::check_error(missing.open(), hal::ErrorCode::not_found, "/nowhere/tty", {});
  std::vector<std::byte> chunk(8);
  CHECK(missing.read(chunk, 0).error().code == hal::ErrorCode::usage);
  const std::string file =
      (std::filesystem::temp_directory_path() / ("compueye-uart-" + std::to_string(::getpid()))).string();
  std::ofstream(file) << "keep me";
  for (const std::string& no_port : {file, std::string("/dev/zero")}) {
    UartTransport none(no_port, 115'200);
    test::check_error(none.open(), hal::ErrorCode::usage, no_port, {});
  }
  std::ifstream kept(file);
  CHECK(std::string(std::istreambuf_iterator<char>(kept), {}) == "keep me");
  std::filesystem::remove(file);
  const int master = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (master < 0 || ::grantpt(master) != 0 || ::unlockpt(master) != 0) return;
  const std::string slave = ::ptsname(master);
  UartTransport odd(slave, 12'345);
  test::check_error(odd.open(), hal::ErrorCode::usage, slave, {"12345"});
  UartTransport good(slave, 921'600);
  CHECK(good.open());
  ::close(master);
}
