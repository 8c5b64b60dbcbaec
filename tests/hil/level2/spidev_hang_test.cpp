// An ioctl of spidev that the kernel does not come back from, under the real transport::SpidevBus.

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <thread>
#include <utility>

#include "drivers/device/converter_source.hpp"
#include "drivers/device/hang_proof_source.hpp"
#include "drivers/transport/spi_spidev.hpp"
#include "tests/drivers/device/converter_rig.hpp"
#include "tests/drivers/device/hang_gate.hpp"
#include "tests/drivers/device/hanging_wires.hpp"
#include "tests/hil/spi_shim.hpp"

namespace compueye::hil {
namespace {

using device::HangProofSource;
using device::tests::Gate;
using device::tests::HangGate;
using test::ms;

constexpr const char* held_path = "/dev/spidev8.0";
constexpr device::tests::ConverterEye one_chip{"mcp3208", 1, 200.0, false, false};

/// The kernel's side: every message passes by the gate.
class HeldChip final : public SpiDeviceModel {
 public:
  HeldChip(frontend::EmulatedFrontEnd& chip, std::shared_ptr<hal::VirtualClock> clock, Gate gate)
      : chip_(chip), clock_(std::move(clock)), gate_(std::move(gate)) {}
  void transfer(std::span<const hal::SpiSegment> segments) override {
    gate_->pass("ioctl");
    static_cast<void>(chip_.exchange(segments, clock_->now_ns()));
  }

 private:
  frontend::EmulatedFrontEnd& chip_;
  std::shared_ptr<hal::VirtualClock> clock_;
  Gate gate_;
};

struct HeldBench {
  explicit HeldBench(std::size_t ahead) {
    shim_spidev(held_path, file);
    device::ConverterSettings settings = device::tests::source_of(chips);
    source = HangProofSource::create(
                 held_path,
                 [settings, gate = gate](hal::Clock& by) -> hal::Result<HangProofSource::Source> {
                   device::ConverterWires wires;
                   wires.data = std::make_unique<transport::SpidevBus>(held_path);
                   auto made = device::ConverterSource::create(settings, hanging(std::move(wires), gate), by);
                   if (!made) return tl::unexpected(made.error());
                   return std::move(*made);
                 },
                 device::tests::time_of(clock, gate), ahead)
                 .value();
  }

  std::shared_ptr<hal::VirtualClock> clock = std::make_shared<hal::VirtualClock>(test::second);
  Gate gate = std::make_shared<HangGate>();
  frontend::EmulatedFrontEnd chips{device::tests::emulated(one_chip), clock->now_ns()};
  HeldChip chip{chips, clock, gate};
  EmulatedSpidev file{chip};
  std::unique_ptr<HangProofSource> source;
};

}  // namespace

TEST_CASE("spi: an ioctl that the kernel keeps holds no read, and frames come again when it lets go") {
  for (const std::size_t ahead : {std::size_t{0}, HangProofSource::usual_ahead}) {
    HeldBench bench(ahead);
    HangProofSource& source = *bench.source;
    REQUIRE(source.start());
    for (int k = 0; k < 5; ++k) REQUIRE(source.read(bench.clock->now_ns() + 100 * ms));
    bench.gate->hang_at("ioctl");
    std::size_t before = 0;
    while (source.read(bench.clock->now_ns() + 100 * ms)) ++before;
    CHECK(before <= ahead);
    REQUIRE(bench.gate->hangs());
    for (int k = 0; k < 10; ++k) {
      const std::int64_t deadline_ns = bench.clock->now_ns() + 100 * ms;
      const auto block = source.read(deadline_ns);
      REQUIRE_FALSE(block);
      CHECK(block.error().code == hal::ErrorCode::timeout);
      CHECK(bench.clock->now_ns() <= deadline_ns + device::latest_answer_ns);
    }
    CHECK(source.recovering());
    bench.gate->release();
    for (int k = 0; k < 20; ++k) {
      const auto block = source.read(bench.clock->now_ns() + 100 * ms);
      REQUIRE(block);
      CHECK(block->valid[3] == 1);
    }
    CHECK(source.account().drops(hal::DropReason::device_overrun) > 100);
    CHECK(source.account().balanced());
    source.stop();
    CHECK(source.counters().back().count == 1);
    REQUIRE(source.close());
    CHECK(open_spidev_files() == 0);
  }
}

TEST_CASE("spi: a device file in whose ioctl the kernel stays is left open, and closed when it lets go") {
  HeldBench bench(0);
  REQUIRE(bench.source->start());
  REQUIRE(bench.source->read(bench.clock->now_ns() + 100 * ms));
  bench.gate->hang_at("ioctl");
  REQUIRE_FALSE(bench.source->read(bench.clock->now_ns() + 100 * ms));
  const std::int64_t begun_ns = bench.clock->now_ns();
  const auto closed = bench.source->close();
  REQUIRE_FALSE(closed);
  CHECK(closed.error().place == "CE-SPI");
  CHECK(closed.error().sentence.find("'read'") != std::string::npos);
  CHECK(bench.clock->now_ns() - begun_ns <= 3 * test::second);
  bench.source.reset();
  CHECK(open_spidev_files() == 1);
  bench.gate->release();
  bench.gate->wait_for("data close", 1);
  while (open_spidev_files() > 0) std::this_thread::yield();
  CHECK(open_spidev_files() == 0);
}

}  // namespace compueye::hil
