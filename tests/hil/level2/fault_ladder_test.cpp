// Level 2 of the ladder: the rows of docs/faults.md behind the real libusb and hidapi. The device's time is held to the
// bounds; the host has a second for what takes 50 ms, so that a busy machine is not taken for a fault.

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "drivers/device/device_source.hpp"
#include "tests/hal/units.hpp"
#include "tests/hil/fault_table.hpp"
#include "tests/hil/level1/fault_scripts.hpp"
#include "tests/hil/level2/benches.hpp"
#include "tests/source_folder.hpp"

namespace compueye::hil {
namespace {

using compueye::test::ms;
using compueye::test::second;
constexpr std::int64_t silence_ns = second, usual_silence_ns = 50 * ms;
constexpr std::int64_t period_ns = 10 * ms;  // as DeviceSettings have it
constexpr std::uint64_t calm_frames = 10;

/// Rows that others play on the real libraries, or that want a host which does not wait.
constexpr std::array elsewhere{
    std::string_view("re-plug"),  // check_unplugging(), and usb_threads_test.cpp
    std::string_view("loose plug"),
    std::string_view("unplug"),
    std::string_view("re-plug of another"),
    std::string_view("re-plug of another, then of ours"),
    std::string_view("silence"),  // shorter than what is silence here
    std::string_view("babble"),
    std::string_view("mute"),
    std::string_view("reboots"),
    std::string_view("requests not answered"),  // every answer is waited for here
    std::string_view("requests not answered until bus reset"),
    std::string_view("requests not answered, frames come"),
    std::string_view("answers lost"),
};

/// Opening a HID device is no reset of its bus.
constexpr std::array cured_by_reset{
    std::string_view("requests refused until bus reset"),
    std::string_view("babble until bus reset"),
};

/// The number in its stream of the frame that a block shows: all its valid codes agree on one. 12 bits tell it modulo
/// 4096.
std::uint64_t shown_frame(const hal::SampleBlock& block) {
  for (std::uint64_t frame = 0; frame < 4096; ++frame) {
    bool agrees = true;
    for (std::size_t k = 0; agrees && k < block.codes.size(); ++k) {
      agrees = block.valid[k] == 0 || block.codes[k] == protocol::tests::shown_code(frame, k, 12);
    }
    if (agrees) return frame;
  }
  FAIL("a block shows no frame");
  return 0;
}

struct Played {
  std::string outcome;
  std::int64_t after_ns = 0;  ///< the fault was over, in the device's time
  hal::FrameAccount account;
  std::vector<hal::Counter> counters;
  std::uint64_t made = 0;
};

template <class Port, class Transport>
class Conversation {
 public:
  Conversation(Testbed& testbed, const FaultScript& script, const protocol::EmulatorSettings& settings)
      : script_(script), settings_(settings), port_(testbed, settings) {
    port_.plug();
  }
  ~Conversation() { port_.unplug(); }
  Conversation(const Conversation&) = delete;
  Conversation& operator=(const Conversation&) = delete;

  Played play() {
    device::DeviceSettings wanted;
    wanted.bus = settings_.bus;
    wanted.exposure_ns = ms;
    wanted.silence_ns = silence_ns;
    wanted.start_limit_ns = patience_ns;
    wanted.recovery_limit_ns = 5 * second;
    auto source = device::DeviceSource::create(wanted, std::make_unique<Unhurried<Transport>>(), clock_);
    REQUIRE(source);
    REQUIRE((*source)->start());
    for (int f = 0; f < 5; ++f) REQUIRE((*source)->read(clock_.now_ns() + patience_ns));
    Played played = look_on(**source, inject() + script_.lasts_ns);
    (*source)->stop();
    played.account = (*source)->account();
    played.counters = (*source)->counters();
    played.made = port_.cable.with([](auto& eye, auto) { return eye.truth().frames - eye.truth().frames_unasked; });
    return played;
  }

 private:
  std::int64_t inject() {
    return port_.cable.with([&](protocol::DeviceEmulator& eye, std::int64_t now_ns) {
      FaultMoment moment;
      moment.at_ns = now_ns + 13 * ms;
      moment.at_frame = 8;
      moment.parts = 2;
      moment.serial = settings_.descriptor.serial.c_str();
      // What waits in between comes first.
      made_by_then_ = eye.truth().frames + static_cast<std::uint64_t>((13 * ms + script_.lasts_ns) / period_ns) + 5;
      for (protocol::EmulatorFault fault : script_.faults(moment)) eye.inject(std::move(fault));
      return moment.at_ns;
    });
  }
  [[nodiscard]] std::int64_t device_ns() {
    return port_.cable.with([](auto&, std::int64_t now_ns) { return now_ns; });
  }

  Played look_on(device::DeviceSource& source, std::int64_t over_ns) {
    Played played;
    played.outcome = "recovered";
    std::uint64_t calm = 0, next = 0, reboots = 0;
    std::int64_t right_ns = over_ns;
    while (calm < calm_frames || source.account().produced < made_by_then_) {
      const auto block = source.read(clock_.now_ns() + patience_ns);
      if (!block) {
        REQUIRE(block.error().code == hal::ErrorCode::disconnected);
        played.outcome = "stopped safely";
        played.after_ns = device_ns() - over_ns;
        return played;
      }
      static_cast<void>(shown_frame(*block));
      const std::uint64_t reboots_now = source.failures()[device::Failure::rebooted];
      const bool anew = std::exchange(reboots, reboots_now) != reboots_now;
      const bool right = whole(*block) && !block->flags.overrun && (block->flags.time_ok || anew);
      if (!right) played.outcome = "degraded and flagged";
      if (!right || block->frame != next) {
        calm = 0;
        right_ns = std::max(over_ns, device_ns());
      }
      next = block->frame + 1;
      ++calm;
    }
    played.after_ns = right_ns - over_ns;
    return played;
  }

  const FaultScript& script_;
  protocol::EmulatorSettings settings_;
  Port port_;
  hal::MonotonicClock clock_;
  std::uint64_t made_by_then_ = 0;  // frames, when the fault is over
};

bool is_elsewhere(std::string_view fault, const protocol::Bus* bus) {
  return std::find(elsewhere.begin(), elsewhere.end(), fault) != elsewhere.end() ||
         (bus == &protocol::hid_bus &&
          std::find(cured_by_reset.begin(), cured_by_reset.end(), fault) != cured_by_reset.end());
}

bool has_forgotten(const std::vector<hal::Counter>& counters) {
  return std::any_of(counters.begin(), counters.end(), [](const auto& each) {
    return (each.name == "rebooted" || each.name == "other_version") && each.count > 0;
  });
}

template <class Port, class Transport>
void check_bus(const protocol::Bus* bus) {
  HIL_TESTBED(testbed);
  const auto rows = read_fault_table(test::source_path("docs/faults.md"));
  std::size_t rows_played = 0, rows_elsewhere = 0;
  for (const FaultScript& script : fault_scripts()) {
    if (is_elsewhere(script.fault, bus)) {
      ++rows_elsewhere;
      continue;
    }
    const auto row = std::find_if(rows.begin(), rows.end(), [&](const auto& each) {
      return each.bus == bus->name && each.fault == script.fault;
    });
    REQUIRE(row != rows.end());
    CAPTURE(row->fault);
    protocol::EmulatorSettings settings = eye("CE-" + std::to_string(++rows_played), 64, bus);
    settings.descriptor.most_payload = bus == &protocol::usb_bus ? 75 : settings.descriptor.most_payload;
    settings.boot_ns = 0;
    Conversation<Port, Transport> conversation(testbed, script, settings);
    const Played played = conversation.play();
    CAPTURE(hal::text_of(played.counters));
    CHECK(played.outcome == row->outcome);
    // It may have to find out twice.
    CHECK(played.after_ns <= row->bound_ms * ms + 2 * (silence_ns - usual_silence_ns));
    CHECK(played.account.balanced());
    // What one made that has forgotten follows from its rate, and a busy machine slows its time down.
    if (!has_forgotten(played.counters)) CHECK(played.account.produced == played.made);
    check_drops(played.account, *row);
    check_counters(played.counters, *row);
  }
  CHECK(rows_played > 15);
  CHECK(rows_elsewhere == elsewhere.size() + (bus == &protocol::hid_bus ? cured_by_reset.size() : 0));
}

}  // namespace

TEST_CASE("level 2, usb: what docs/faults.md says of a fault holds behind libusb") {
  check_bus<UsbPort, transport::UsbTransport>(&protocol::usb_bus);
}

TEST_CASE("level 2, hid: what docs/faults.md says of a fault holds behind hidapi") {
  check_bus<HidPort, transport::HidTransport>(&protocol::hid_bus);
}

}  // namespace compueye::hil
