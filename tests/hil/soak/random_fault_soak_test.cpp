// Random faults on an eye that streams: nothing may go unaccounted. A short run here; tools/soak runs a million blocks.

#include <array>
#include <chrono>
#include <cstdlib>

#include "tests/drivers/device/eye_rig.hpp"
#include "tests/hil/soak/random_faults.hpp"

using namespace compueye;
using namespace compueye::device;
using namespace compueye::device::tests;
using namespace compueye::hil;

namespace {

struct SoakResult {
  hal::FrameAccount account;
  std::string failures;
  std::uint64_t made = 0;  // by the device
  std::uint64_t incidents = 0;
  std::int64_t miscounted = 0;       // by the number of the last frame
  std::int64_t worst_outage_ns = 0;  // from one frame to the next
};

/// For whoever has to find out what went wrong.
std::string describe(const Incident& incident, std::int64_t now_ns) {
  std::string text = "reader sleeps " + std::to_string(incident.reader_sleeps_ns / ms) + " ms";
  for (const EmulatorFault& fault : incident.faults) {
    text += "; " + std::string(protocol::name(fault.kind)) + " after " + std::to_string((fault.at_ns - now_ns) / ms) +
            " ms for " + std::to_string(fault.duration_ns / ms) + " ms, count " + std::to_string(fault.count) +
            ", value " + std::to_string(fault.value);
  }
  return text;
}

/// How much goes wrong at once.
enum class Wildness : std::uint8_t { incidents, meetings };

/// Until `blocks` frames were delivered.
SoakResult soak(const Bus* bus, std::uint64_t blocks, std::uint64_t seed, Wildness wildness) {
  constexpr std::array drifts_ppm{0.0, 40.0, -40.0, 300.0, -300.0};
  const bool wild = wildness == Wildness::meetings;
  auto emulator = protocol::tests::eye_settings(bus, 16, seed);
  emulator.fifo_bytes = 8192;
  emulator.descriptor.most_payload = 15;  // two packets a frame
  if (bus == &hid_bus) emulator.descriptor.most_payload = 65535;
  EyeRig rig(emulator, source_settings(bus), std::make_unique<hal::VirtualClock>(10 * second),
             wild ? drifts_ppm[seed % drifts_ppm.size()] : 0.0);
  rig.estimates_may_err = wild;
  RandomFaults faults(seed, emulator.descriptor.serial);
  SoakResult result;
  REQUIRE(rig.start());
  std::uint64_t next_incident = faults.calm_frames();
  std::int64_t last_frame_ns = rig.clock.now_ns(), over_ns = 0;
  std::string last_incident;
  while (rig.delivered() < blocks || rig.clock.now_ns() < over_ns + second) {
    CAPTURE(seed);
    CAPTURE(last_incident);
    const auto block =
        rig.next_frame(60 * second, wild ? (10 + 10 * static_cast<std::int64_t>(rig.delivered() % 10)) * ms : 100 * ms);
    CAPTURE((block ? std::string() : block.error().text()));
    REQUIRE(block);
    result.worst_outage_ns = std::max(result.worst_outage_ns, rig.clock.now_ns() - last_frame_ns);
    last_frame_ns = rig.clock.now_ns();
    if (rig.delivered() < next_incident || rig.clock.now_ns() < over_ns) continue;
    Incident incident = wild ? faults.meeting(rig.clock.now_ns()) : faults.next(rig.clock.now_ns());
    last_incident = describe(incident, rig.clock.now_ns());
    for (EmulatorFault& fault : incident.faults) rig.inject(std::move(fault));
    if (incident.reader_sleeps_ns > 0) {
      rig.clock.advance(incident.reader_sleeps_ns);
      last_frame_ns += incident.reader_sleeps_ns;
    }
    over_ns = incident.over_ns;
    ++result.incidents;
    next_incident = rig.delivered() + faults.calm_frames();
  }
  rig.source().stop();
  result.account = rig.source().account();
  result.failures = hal::text_of(rig.source().counters());
  result.made = rig.shown.made();
  result.miscounted = rig.miscounted();
  return result;
}

std::uint64_t unaccounted(const SoakResult& result) {
  const hal::FrameAccount& account = result.account;
  const std::uint64_t known = account.delivered + account.total_dropped();
  return std::max(known, result.made) - std::min(known, result.made);
}

void soak_both(std::uint64_t blocks, std::uint64_t seed, Wildness wildness) {
  for (const Bus* const bus : protocol::buses) {
    const auto began = std::chrono::steady_clock::now();
    const SoakResult result = soak(bus, blocks, seed, wildness);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - began;
    CHECK(unaccounted(result) == static_cast<std::uint64_t>(std::abs(result.miscounted)));
    if (wildness == Wildness::incidents) CHECK(result.miscounted == 0);
    CHECK(result.account.balanced());
    CHECK(result.made >= blocks);
    CHECK(result.incidents > blocks / 500);
    CHECK(result.account.delivered > blocks / 2);
    CHECK(result.worst_outage_ns <= 10 * second);  // requests refused many times in a row cost most
    std::string drops;
    for (std::size_t k = 0; k < hal::drop_reason_count; ++k) {
      if (result.account.dropped[k] == 0) continue;
      drops += ", " + std::string(hal::name(static_cast<hal::DropReason>(k))) + " " +
               std::to_string(result.account.dropped[k]);
    }
    MESSAGE((bus == &hid_bus ? "hid: " : "usb: ")
            << result.made << " blocks of 16 samples made in " << result.incidents << " incidents, "
            << result.account.delivered << " delivered" << drops << "; estimated " << result.account.estimated
            << ", unaccounted " << unaccounted(result) << "; longest outage " << result.worst_outage_ns / ms << " ms; "
            << result.failures << "; " << seconds.count() << " s");
  }
}

std::uint64_t number_in(const char* variable, std::uint64_t otherwise) {
  const char* const text = std::getenv(variable);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

}  // namespace

TEST_CASE("random faults leave nothing unaccounted: 20,000 blocks a bus") {
  soak_both(20'000, 1, Wildness::incidents);
}

TEST_CASE("faults that meet: read() keeps its deadline, every sample its frame, and the books what was counted") {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) soak_both(2'000, seed, Wildness::meetings);
}

TEST_CASE("soak: random faults, as many blocks a bus as tools/soak says" * doctest::skip()) {
  const std::uint64_t blocks = number_in("COMPUEYE_SOAK_BLOCKS", 1'000'000), seed = number_in("COMPUEYE_SOAK_SEED", 1);
  soak_both(blocks, seed, Wildness::incidents);
  soak_both(blocks, seed, Wildness::meetings);
}
