// device::HangProofLines over lines each of whose calls may not come back.

#include <doctest/doctest.h>

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "drivers/device/hang_limits.hpp"
#include "drivers/device/hang_proof_lines.hpp"
#include "tests/drivers/device/hang_gate.hpp"
#include "tests/drivers/device/hanging_wires.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/hal/no_threads.hpp"
#include "tests/hal/units.hpp"

namespace compueye::device::tests {
namespace {

using Levels = std::shared_ptr<std::vector<std::uint32_t>>;

/// Remembers what it was set to.
class Lamps final : public hal::OutputLines {
 public:
  Lamps(Levels levels, Gate gate) : levels_(std::move(levels)), gate_(std::move(gate)) {}
  ~Lamps() override { gate_->pass("gone"); }
  [[nodiscard]] const std::string& name() const noexcept override { return name_; }
  [[nodiscard]] int count() const noexcept override { return 3; }
  [[nodiscard]] hal::Result<void> open() override { return {}; }
  void close() noexcept override {}
  [[nodiscard]] hal::Result<void> set(std::uint32_t levels) override {
    if (levels == 7) return hal::fail(hal::ErrorCode::disconnected, name_, "the chip went away");
    levels_->push_back(levels);
    return {};
  }

 private:
  Levels levels_;
  Gate gate_;
  std::string name_ = "gpiochip0 lines 5, 6 and 13";
};

struct LampRig {
  std::shared_ptr<hal::VirtualClock> clock = std::make_shared<hal::VirtualClock>(test::second);
  Gate gate = std::make_shared<HangGate>();
  Levels levels = std::make_shared<std::vector<std::uint32_t>>();
  std::unique_ptr<HangProofLines> lines = std::make_unique<HangProofLines>(
      std::make_unique<HangingOutputs>(std::make_unique<Lamps>(levels, gate), "lamps", gate), time_of(clock, gate));
};

}  // namespace

TEST_CASE("hang: lines behind a thread of their own are the same lines") {
  LampRig rig;
  CHECK(rig.lines->name() == "gpiochip0 lines 5, 6 and 13");
  CHECK(rig.lines->count() == 3);
  CHECK(rig.lines->set(1).error().code == hal::ErrorCode::usage);
  rig.lines->close();
  {
    const test::NoThreads none;
    CHECK(rig.lines->open().error().code == hal::ErrorCode::no_space);
  }
  REQUIRE(rig.lines->open());
  for (const std::uint32_t each : {1U, 5U, 0U}) REQUIRE(rig.lines->set(each));
  CHECK(rig.lines->set(7).error().code == hal::ErrorCode::disconnected);
  REQUIRE(rig.lines->set(2));
  CHECK(*rig.levels == std::vector<std::uint32_t>{1, 5, 0, 2});
  rig.lines->close();
  REQUIRE(rig.lines->open());
  CHECK(rig.clock->now_ns() == test::second);
  rig.lines.reset();
  CHECK(rig.gate->passed("gone") == 1);
}

TEST_CASE("hang: a line that cannot be set is an error in its time, and works again when the driver lets go") {
  const std::int64_t budget_ns = limit_of(DeviceCall::set).budget_ns;
  LampRig rig;
  rig.gate->hang_at("lamps open");
  test::check_error(rig.lines->open(), hal::ErrorCode::timeout, rig.lines->name(), {"open", "2000"});
  CHECK(rig.clock->now_ns() == test::second + budget_ns);
  rig.gate->release();
  REQUIRE(rig.lines->open());
  REQUIRE(rig.lines->set(1));
  rig.gate->hang_at("lamps set");
  const std::int64_t begun_ns = rig.clock->now_ns();
  test::check_error(rig.lines->set(2), hal::ErrorCode::timeout, rig.lines->name(), {"set", "2000"});
  CHECK(rig.clock->now_ns() == begun_ns + budget_ns);
  CHECK(rig.lines->set(4).error().code == hal::ErrorCode::timeout);
  CHECK(rig.clock->now_ns() <= begun_ns + 3 * budget_ns);
  rig.gate->release();
  REQUIRE(rig.lines->set(5));
  CHECK(*rig.levels == std::vector<std::uint32_t>{1, 2, 5});  // 4 was never asked for
}

TEST_CASE("hang: lines that hang are left behind in their time, and closed when the driver lets go") {
  for (const std::string call : {"lamps set", "lamps close"}) {
    CAPTURE(call);
    LampRig rig;
    REQUIRE(rig.lines->open());
    rig.gate->hang_at(call);
    if (call == "lamps set") CHECK_FALSE(rig.lines->set(1));
    const std::int64_t begun_ns = rig.clock->now_ns();
    rig.lines->close();
    rig.lines.reset();
    CHECK(rig.clock->now_ns() - begun_ns <= 2 * limit_of(DeviceCall::close).budget_ns);
    CHECK(rig.gate->passed("gone") == 0);
    rig.gate->release();
    rig.gate->wait_for("gone", 1);
  }
}

}  // namespace compueye::device::tests
