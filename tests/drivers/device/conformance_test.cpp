#include "drivers/device/conformance.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <deque>
#include <functional>
#include <string>
#include <vector>

#include "drivers/protocol/emulated_transport.hpp"
#include "tests/drivers/device/tampered_transport.hpp"
#include "tests/drivers/protocol/emulated_eye.hpp"

using namespace compueye;
using namespace compueye::device;
using namespace compueye::protocol;
using compueye::device::tests::TamperedTransport;
using compueye::protocol::tests::eye_settings;
using compueye::protocol::tests::shown;
using Verdict = ConformanceRow::Verdict;

namespace {

/// An emulated eye with somebody on the way to it.
struct WrongEye {
  explicit WrongEye(EmulatorSettings settings)
      : bus(*settings.bus), device(DeviceEmulator::create(settings, shown(12)).value()), transport(device, clock) {}

  std::vector<ConformanceRow> rows() {
    auto found = check_conformance(transport, clock, bus);
    REQUIRE_MESSAGE(found.has_value(), found.error().text());
    return *found;
  }
  /// Names of the rows that fail.
  std::vector<std::string> failures() {
    std::vector<std::string> names;
    for (const ConformanceRow& row : rows()) {
      if (row.verdict != Verdict::fail) continue;
      CHECK_FALSE(row.why.empty());
      names.push_back(row.name);
    }
    return names;
  }

  const Bus& bus;
  hal::VirtualClock clock{10'000'000'000};
  DeviceEmulator device;
  TamperedTransport transport;
};

/// A host that has read on for a tenth of a second before each RESET_PIPES, and hands that out behind it.
class ReadAhead final : public hal::ByteTransport {
 public:
  ReadAhead(hal::ByteTransport& under, hal::Clock& clock) : under_(under), clock_(clock) {}

  [[nodiscard]] const hal::TransportDescription& describe() const noexcept override { return under_.describe(); }
  [[nodiscard]] hal::Result<void> open() override { return under_.open(); }
  void close() noexcept override { under_.close(); }
  [[nodiscard]] hal::Result<std::size_t> read(std::span<std::byte> into, std::int64_t deadline_ns) override {
    if (ahead_.empty()) return under_.read(into, deadline_ns);
    const std::vector<std::byte> next = ahead_.front();
    ahead_.pop_front();
    REQUIRE(next.size() <= into.size());
    std::copy(next.begin(), next.end(), into.begin());
    return next.size();
  }
  [[nodiscard]] hal::Result<std::size_t> control(std::uint8_t request, std::span<const std::byte> payload,
                                                 std::span<std::byte> reply, std::int64_t deadline_ns) override {
    std::vector<std::byte> chunk(4096);
    while (request == number(Request::reset_pipes) && ahead_.size() < 30) {
      const auto got = under_.read(chunk, clock_.now_ns() + 100'000'000);
      if (!got) break;
      ahead_.emplace_back(chunk.begin(), chunk.begin() + static_cast<std::ptrdiff_t>(*got));
      ++handed_on;
    }
    return under_.control(request, payload, reply, deadline_ns + 4'000'000'000);
  }
  int handed_on = 0;

 private:
  hal::ByteTransport& under_;
  hal::Clock& clock_;
  std::deque<std::vector<std::byte>> ahead_;
};

bool has(const std::vector<std::string>& names, std::string_view begin) {
  return std::any_of(names.begin(), names.end(), [&](const std::string& name) { return name.starts_with(begin); });
}

}  // namespace

TEST_CASE("an eye after the page keeps every promise, on every bus") {
  for (const Bus* bus : buses) {
    for (const int channels : {5, 64, 200}) {
      CAPTURE(bus->name);
      CAPTURE(channels);
      auto settings = eye_settings(bus, channels);
      settings.descriptor.most_payload = 120;  // frames in several packets
      WrongEye eye(settings);
      int passed = 0;
      for (const ConformanceRow& row : eye.rows()) {
        CAPTURE(row.name);
        CAPTURE(row.why);
        CHECK(row.verdict != Verdict::fail);
        CHECK((row.verdict == Verdict::skipped) == !row.why.empty());
        passed += row.verdict == Verdict::pass ? 1 : 0;
      }
      CHECK(passed >= (bus == &usb_bus ? 23 : 18));
      CHECK(eye.device.state() != DeviceState::streaming);
    }
  }
}

TEST_CASE("what a host has read of the stream before is not held against the next one") {
  for (const Bus* bus : buses) {
    CAPTURE(bus->name);
    WrongEye eye(eye_settings(bus));
    ReadAhead host(eye.transport, eye.clock);
    const auto rows = check_conformance(host, eye.clock, *bus);
    REQUIRE(rows.has_value());
    for (const ConformanceRow& row : *rows) {
      CAPTURE(row.name);
      CAPTURE(row.why);
      CHECK(row.verdict != Verdict::fail);
    }
    CHECK(host.handed_on > 20);
  }
}

TEST_CASE("an eye that does what the page forbids fails the row that says so") {
  struct Wrong {
    const char* what;
    const char* row;
    std::vector<EmulatorFault> faults;
  };
  const std::vector<Wrong> all{
      {"another configuration", "GET_CONFIG", {{.kind = FaultKind::wrong_echo}}},
      {"a wrong bit", "packets are whole", {{.kind = FaultKind::bit_error, .at_frame = 5}}},
      {"half a packet", "packets are whole", {{.kind = FaultKind::short_read, .at_frame = 5}}},
      {"a packet left out", "every packet has the next number", {{.kind = FaultKind::lose_packets, .at_frame = 5}}},
      {"a packet twice", "every packet has the next number", {{.kind = FaultKind::duplicate_packets, .at_frame = 5}}},
      {"a clock that steps",
       "times grow",
       {{.kind = FaultKind::clock_jump, .at_frame = 4, .value = 5'000'000},
        {.kind = FaultKind::clock_jump, .at_frame = 9, .value = 5'000'000}}},
      {"silence", "START streams", {{.kind = FaultKind::silence, .at_frame = 5}}},
      {"a halt", "START streams", {{.kind = FaultKind::stall_stream, .at_frame = 5}}},
      {"a new start", "START streams", {{.kind = FaultKind::reboot, .at_frame = 5}}},
      {"a stream unasked", "every packet carries", {{.kind = FaultKind::reboot, .at_frame = 5, .value = 1}}},
  };
  for (const Wrong& wrong : all) {
    CAPTURE(wrong.what);
    auto settings = eye_settings(&usb_bus);
    settings.faults = wrong.faults;
    CHECK(has(WrongEye(settings).failures(), wrong.row));
  }
  auto babbling = eye_settings(&usb_bus);
  babbling.faults = {{.kind = FaultKind::babble, .at_frame = 5}};
  CHECK(has(WrongEye(babbling).failures(), "START streams"));
  auto hid = eye_settings(&hid_bus);
  hid.faults = {{.kind = FaultKind::bit_error, .at_frame = 3}, {.kind = FaultKind::lose_packets, .at_frame = 6}};
  const auto failures = WrongEye(hid).failures();
  CHECK(has(failures, "packets are whole"));
  CHECK(has(failures, "a frame has every channel"));
}

TEST_CASE("bytes that are sealed and wrong fail their own row alone") {
  struct Wrong {
    const char* row;
    std::function<void(FrameHeader&)> change;
  };
  const std::vector<Wrong> all{
      {"every packet carries", [](FrameHeader& h) { ++h.config_id; }},
      {"every packet has the next number", [](FrameHeader& h) { h.seq += 7; }},
      {"a frame has every channel", [](FrameHeader& h) { h.flags &= ~packet_flag::eof; }},
      {"SAT stands", [](FrameHeader& h) { h.flags ^= packet_flag::sat; }},
      {"OVERRUN stands", [](FrameHeader& h) { h.flags |= packet_flag::overrun; }},
      {"frames count", [](FrameHeader& h) { h.dropped = 3; }},
      {"times grow", [](FrameHeader& h) { h.t_ns += 15'000'000; }},
  };
  for (const Wrong& wrong : all) {
    CAPTURE(wrong.row);
    auto settings = eye_settings(&usb_bus);
    settings.events = false;
    WrongEye eye(settings);
    // Whole packets come in one read; each that is of frame 7 is changed and sealed again.
    eye.transport.at_bytes = [&](std::span<std::byte> bytes) {
      PacketStream stream(eye.device.descriptor().packet_limits());
      stream.feed(bytes);
      std::size_t at = 0;
      while (auto packet = stream.next()) {
        const std::size_t length = packet->header.packet_bytes();
        if (packet->header.frame == 7) {
          const std::vector<std::byte> payload(packet->payload.begin(), packet->payload.end());
          wrong.change(packet->header);
          CHECK(encode_packet(packet->header, payload, bytes.subspan(at, length)) == length);
        }
        at += length;
      }
    };
    const auto failures = eye.failures();
    CHECK(has(failures, wrong.row));
    CHECK(failures.size() <= 2);  // of the everyday stream, and of that of a full memory
  }
}

TEST_CASE("requests that are answered wrong fail their row") {
  const auto with = [](Request what, const std::function<void(hal::Result<std::size_t>&)>& change) {
    WrongEye eye(eye_settings(&usb_bus));
    eye.transport.at_request = [&](Request request, hal::Result<std::size_t>& outcome) {
      if (request == what) change(outcome);
    };
    return eye.failures();
  };
  const auto refuse = [](hal::Result<std::size_t>& outcome) {
    outcome = hal::fail(hal::ErrorCode::io, "eye", "stall");
  };
  const auto take = [](hal::Result<std::size_t>& outcome) { outcome = std::size_t{0}; };
  CHECK(has(with(Request::ping, refuse), "PING"));
  CHECK(has(with(Request::reset_pipes, refuse), "RESET_PIPES"));
  CHECK(has(with(Request::get_desc, refuse), "the descriptor"));
  CHECK(has(with(Request::set_config, take), "a configuration beyond"));
  CHECK(has(with(Request::start, take), "SET_CONFIG and START"));
  CHECK(has(with(Request::stop, refuse), "STOP"));
  CHECK(has(with(Request::set_illum, take), "light"));
  // Without a descriptor nothing else can be asked, and that is said.
  WrongEye mute(eye_settings(&usb_bus));
  mute.transport.at_request = [&](Request request, hal::Result<std::size_t>& outcome) {
    if (request == Request::get_desc) refuse(outcome);
  };
  const auto rows = mute.rows();
  CHECK(std::count_if(rows.begin(), rows.end(), [](const auto& row) { return row.verdict == Verdict::skipped; }) == 12);
}

TEST_CASE("a walk that is stopped, or finds no eye, is an error") {
  WrongEye eye(eye_settings(&usb_bus));
  int asked = 0;
  const auto stopped =
      check_conformance(eye.transport, eye.clock, usb_bus, [&](std::string_view) { return ++asked < 3; });
  CHECK(stopped.error().code == hal::ErrorCode::interrupted);
  CHECK(asked == 3);
  eye.device.inject({.kind = FaultKind::unplug, .at_ns = eye.clock.now_ns()});
  CHECK(check_conformance(eye.transport, eye.clock, usb_bus).error().code == hal::ErrorCode::not_found);
}
