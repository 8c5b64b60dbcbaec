// Level 1 of the ladder: every fault of docs/faults.md on both emulated buses, 16 seeds each, in virtual time.

#include <algorithm>
#include <map>
#include <set>

#include "tests/drivers/device/eye_rig.hpp"
#include "tests/hil/fault_table.hpp"
#include "tests/hil/level1/fault_scripts.hpp"
#include "tests/source_folder.hpp"

using namespace compueye;
using namespace compueye::device;
using namespace compueye::device::tests;
using namespace compueye::hil;

namespace {

constexpr std::uint64_t seeds = 16;
constexpr std::uint64_t calm_frames = 20;  // in a row, to call it over
constexpr std::int64_t recovery_limit_ns = 5 * second;

const std::vector<ExpectedOutcome>& expected_outcomes() {
  static const std::vector<ExpectedOutcome> rows = read_fault_table(compueye::test::source_path("docs/faults.md"));
  return rows;
}

/// Frames of two to four packets or reports.
protocol::EmulatorSettings ladder_eye(const Bus* bus, std::uint64_t seed) {
  auto emulator = protocol::tests::eye_settings(bus, 64 + static_cast<int>(seed) * 5, seed);
  emulator.descriptor.most_payload = 75;
  return emulator;
}

std::uint64_t parts_a_frame(const protocol::EmulatorSettings& emulator) {
  const int most = emulator.bus == &hid_bus ? protocol::hid_channels_per_report : 50;
  return static_cast<std::uint64_t>((emulator.descriptor.channels + most - 1) / most);
}

struct Ending {
  std::string outcome;
  std::int64_t after_ms = 0;  ///< the fault was over
};

/// Plays one fault on an eye that streams, and looks on until it is over.
class Conversation {
 public:
  Conversation(const FaultScript& script, const Bus* bus, std::uint64_t seed)
      : script_(script), emulator_(ladder_eye(bus, seed)), rig_(emulator_, settings(bus)), seed_(seed) {}

  Ending play() {
    REQUIRE(rig_.start());
    const std::uint64_t before = 5 + seed_ % 7;
    for (std::uint64_t f = 0; f < before; ++f) REQUIRE(rig_.read());
    const std::int64_t over_ns = begin(before) + script_.lasts_ns;
    const Ending ending = look_on(over_ns);
    rig_.source().stop();
    return ending;
  }
  [[nodiscard]] EyeRig& rig() { return rig_; }

 private:
  static DeviceSettings settings(const Bus* bus) {
    DeviceSettings settings = source_settings(bus);
    settings.recovery_limit_ns = recovery_limit_ns;
    return settings;
  }

  std::int64_t begin(std::uint64_t frames) {
    FaultMoment moment;
    std::mt19937_64 random(seed_);
    moment.at_ns = rig_.clock.now_ns() + static_cast<std::int64_t>(random() % 10'000'000);
    moment.at_frame = frames + 1;
    moment.parts = parts_a_frame(emulator_);
    moment.seed = seed_;
    moment.serial = emulator_.descriptor.serial.c_str();
    for (EmulatorFault fault : script_.faults(moment)) rig_.device.inject(std::move(fault));
    return moment.at_ns;
  }

  [[nodiscard]] std::uint64_t faults_begun() const {
    std::uint64_t begun = 0;
    for (const std::uint64_t count : rig_.device.truth().faults) begun += count;
    return begun;
  }

  /// Until recovery is given up, or whole frames have come one after the other for a while.
  Ending look_on(std::int64_t over_ns) {
    const std::int64_t latest_ns = over_ns + 60 * second;
    bool degraded = false;
    std::uint64_t calm = 0, last_frame = 0, reboots = 0;
    std::int64_t right_since_ns = over_ns;
    while (calm < calm_frames || rig_.clock.now_ns() < over_ns + second / 2) {
      REQUIRE(rig_.clock.now_ns() < latest_ns);
      const std::uint64_t invalid_before = rig_.invalid_channels();
      const auto block = rig_.read(20 * ms);
      if (!block) {
        if (block.error().code != hal::ErrorCode::timeout) return gave_up(block.error(), over_ns);
        calm = 0;
        continue;
      }
      const std::uint64_t reboots_now = rig_.source().failures()[Failure::rebooted];
      const bool clock_anew = std::exchange(reboots, reboots_now) != reboots_now;
      CHECK((!clock_anew || !block->flags.time_ok));  // a clock that has started anew is said to have
      const bool whole = rig_.invalid_channels() == invalid_before;
      const bool right = whole && !block->flags.overrun && (block->flags.time_ok || clock_anew);
      degraded = degraded || !right;
      if (!right || block->frame != last_frame + 1) {
        calm = 0;
        right_since_ns = std::max(over_ns, rig_.clock.now_ns());
      }
      last_frame = block->frame;
      ++calm;
    }
    CHECK(faults_begun() > 0);
    return {degraded ? "degraded and flagged" : "recovered", (right_since_ns - over_ns) / ms};
  }

  Ending gave_up(const hal::Error& error, std::int64_t over_ns) {
    CHECK(error.code == hal::ErrorCode::disconnected);
    CHECK(error.place == emulator_.descriptor.serial);
    CHECK_FALSE(error.sentence.empty());
    CHECK(rig_.source().state() == MachineState::given_up);
    return {"stopped safely", (rig_.clock.now_ns() - over_ns) / ms};
  }

  const FaultScript& script_;
  protocol::EmulatorSettings emulator_;
  EyeRig rig_;
  std::uint64_t seed_;
};

void check_account(EyeRig& rig, const ExpectedOutcome& expected) {
  const hal::FrameAccount account = rig.source().account();
  CHECK(account.balanced());
  CHECK(account.produced == rig.shown.made());
  CHECK(account.delivered == rig.delivered());
  check_drops(account, expected);
}

/// All seeds of one row; the longest that it took.
std::int64_t check_row(const ExpectedOutcome& expected, const FaultScript& script) {
  const Bus* const bus = expected.bus == "hid" ? &hid_bus : &usb_bus;
  std::int64_t worst_ms = 0;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    CAPTURE(expected.fault);
    CAPTURE(expected.bus);
    CAPTURE(seed);
    Conversation conversation(script, bus, seed);
    const Ending ending = conversation.play();
    const std::vector<hal::Counter> failures = conversation.rig().source().counters();
    CAPTURE(hal::text_of(failures));
    CHECK(ending.outcome == expected.outcome);
    CHECK(ending.after_ms <= expected.bound_ms);
    check_account(conversation.rig(), expected);
    check_counters(failures, expected);
    worst_ms = std::max(worst_ms, ending.after_ms);
  }
  return worst_ms;
}

void check_bus(const std::string& bus) {
  std::map<std::string_view, const FaultScript*> by_name;
  for (const FaultScript& script : fault_scripts()) by_name[script.fault] = &script;
  std::string text;
  for (const ExpectedOutcome& expected : expected_outcomes()) {
    if (expected.bus != bus) continue;
    CAPTURE(expected.fault);
    REQUIRE(by_name.contains(expected.fault));
    const std::int64_t worst_ms = check_row(expected, *by_name.at(expected.fault));
    text +=
        "\n" + std::to_string(worst_ms) + " ms (bound " + std::to_string(expected.bound_ms) + "): " + expected.fault;
  }
  MESSAGE(bus << ", longest of " << seeds << " seeds:" << text);
}

}  // namespace

TEST_CASE("level 1, usb: every fault ends as docs/faults.md says") {
  check_bus("usb");
}

TEST_CASE("level 1, hid: every fault ends as docs/faults.md says") {
  check_bus("hid");
}

TEST_CASE("docs/faults.md and the scripts name the same faults, each bus once, and every fault of the emulator") {
  std::multiset<std::string> rows;
  std::set<std::string> outcomes;
  for (const ExpectedOutcome& expected : expected_outcomes()) {
    rows.insert(expected.fault + " " + expected.bus);
    outcomes.insert(expected.outcome);
  }
  CHECK(outcomes == std::set<std::string>{"recovered", "degraded and flagged", "stopped safely"});
  CHECK(rows.size() == 2 * fault_scripts().size());
  std::set<protocol::FaultKind> kinds;
  for (const FaultScript& script : fault_scripts()) {
    CAPTURE(script.fault);
    CHECK(rows.count(std::string(script.fault) + " usb") == 1);
    CHECK(rows.count(std::string(script.fault) + " hid") == 1);
    for (const EmulatorFault& fault : script.faults({})) kinds.insert(fault.kind);
  }
  CHECK(kinds.size() == protocol::fault_kind_count);
}
