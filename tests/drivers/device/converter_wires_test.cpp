// The wires of device::ConverterSource: those that are missing, that fail for good, and that it moves itself.

#include <doctest/doctest.h>

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/drivers/device/converter_rig.hpp"
#include "tests/hal/error_check.hpp"

namespace compueye::device::tests {

using frontend::FrontEndFaultKind;
using test::ms;

TEST_CASE("data-ready that oscillates for ever is recovered from in vain, and given up") {
  for (const ConverterEye& eye : converter_eyes) {
    if (!frontend::find_front_end(eye.chip)->data_ready) continue;
    CAPTURE(eye.chip);
    ConverterRig rig(eye, test::second);
    REQUIRE(rig.source->start());
    REQUIRE(rig.next());
    rig.inject({.kind = FrontEndFaultKind::edge_storm, .value = rig.period_ns() / 50});
    int delivered = 0;
    bool recovering = false;
    for (int k = 0; k < 100 && rig.last_error.code != hal::ErrorCode::disconnected; ++k) {
      delivered += rig.next(100 * ms).has_value() ? 1 : 0;
      recovering = recovering || rig.source->recovering();
    }
    CHECK(recovering);
    CHECK(delivered < 30);  // the first edge after a restart looks like a frame's
    CHECK(rig.last_error.code == hal::ErrorCode::disconnected);
    CHECK_FALSE(rig.source->recovering());
    CHECK(rig.source->failures()[ConverterFailure::silence] >= 1);
    CHECK(rig.source->account().balanced());
  }
}

TEST_CASE("an eye that is not to be recovered is given up at once, and says so") {
  for (const ConverterEye& eye : converter_eyes) {
    CAPTURE(eye.chip);
    ConverterRig rig(eye, 0);
    REQUIRE(rig.source->start());
    REQUIRE(rig.next());
    rig.inject({.kind = FrontEndFaultKind::bus_error});
    CHECK_FALSE(rig.next());
    CHECK(rig.last_error.code == hal::ErrorCode::disconnected);
    CHECK_FALSE(rig.source->recovering());
  }
}

TEST_CASE("files that are gone for good, and a chip of another kind, end in a sentence") {
  for (const ConverterEye& eye : converter_eyes) {
    CAPTURE(eye.chip);
    {
      ConverterRig rig(eye, 2 * test::second);
      REQUIRE(rig.source->start());
      REQUIRE(rig.next());
      rig.inject({.kind = FrontEndFaultKind::gone});
      CHECK_FALSE(rig.next());
      CHECK(rig.source->recovering());
      for (int k = 0; k < 10 && rig.last_error.code == hal::ErrorCode::timeout; ++k) CHECK_FALSE(rig.next());
      test::check_error(hal::Result<void>(tl::unexpected(rig.last_error)), hal::ErrorCode::disconnected, "CE-SPI", {});
      CHECK(rig.source->failures()[ConverterFailure::gave_up] == 1);
      CHECK(rig.source->failures()[ConverterFailure::absent] > 2);
    }
    for (std::size_t other = 0; other < frontend::front_ends().size(); ++other) {
      if (frontend::front_ends()[other]->name == eye.chip) continue;
      CAPTURE(std::string(frontend::front_ends()[other]->name));
      hal::VirtualClock clock;
      frontend::EmulatedFrontEnd chips(emulated(eye), clock.now_ns());
      chips.inject({.kind = FrontEndFaultKind::other_chip, .value = static_cast<std::int64_t>(other)});
      const auto made = ConverterSource::create(source_of(chips), wires_of(chips, clock), clock);
      REQUIRE_FALSE(made);
      CHECK(made.error().code == hal::ErrorCode::mismatch);
    }
  }
}

TEST_CASE("frame sync is high while a frame is read, and low behind it, whatever becomes of the frame") {
  struct Watched final : hal::OutputLines {
    explicit Watched(std::vector<std::uint32_t>& levels) : levels_(levels) {}
    [[nodiscard]] const std::string& name() const noexcept override { return name_; }
    [[nodiscard]] int count() const noexcept override { return 1; }
    [[nodiscard]] hal::Result<void> open() override { return {}; }
    void close() noexcept override {}
    [[nodiscard]] hal::Result<void> set(std::uint32_t levels) override {
      levels_.push_back(levels);
      return {};
    }
    std::vector<std::uint32_t>& levels_;
    std::string name_ = "sync";
  };
  for (const ConverterEye& eye : converter_eyes) {
    CAPTURE(eye.chip);
    hal::VirtualClock clock;
    frontend::EmulatedFrontEnd chips(emulated(eye), clock.now_ns());
    std::vector<std::uint32_t> levels;
    ConverterWires wires = wires_of(chips, clock);
    wires.sync = std::make_unique<Watched>(levels);
    const auto source = ConverterSource::create(source_of(chips), std::move(wires), clock).value();
    REQUIRE(source->start());
    for (int k = 0; k < 10; ++k) REQUIRE(source->read(clock.now_ns() + test::second));
    chips.inject({.kind = FrontEndFaultKind::bus_error, .at_ns = clock.now_ns()});
    REQUIRE(source->read(clock.now_ns() + test::second));
    REQUIRE(levels.size() == 24);
    for (std::size_t k = 0; k < levels.size(); ++k) CHECK(levels[k] == (k + 1) % 2);
  }
}

TEST_CASE("converters are refused wires that they cannot do without") {
  for (const ConverterEye& eye : converter_eyes) {
    CAPTURE(eye.chip);
    hal::VirtualClock clock;
    frontend::EmulatedFrontEnd chips(emulated(eye), clock.now_ns());
    const frontend::FrontEndRow& chip = *chips.settings().chip;
    const auto refused = [&](auto&& without) {
      ConverterWires wires = wires_of(chips, clock);
      without(wires);
      const auto made = ConverterSource::create(source_of(chips), std::move(wires), clock);
      return !made && made.error().code == hal::ErrorCode::usage;
    };
    CHECK(refused([](ConverterWires& wires) { wires.data.reset(); }));
    CHECK(refused([](ConverterWires& wires) { wires.ready.reset(); }) == chip.data_ready);
    CHECK(refused([](ConverterWires& wires) { wires.settings.reset(); }) == chip.settings_bus);
    CHECK(refused([](ConverterWires& wires) { wires.select.reset(); }) == !chip.chain);
  }
}

}  // namespace compueye::device::tests
