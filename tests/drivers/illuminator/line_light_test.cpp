#include "drivers/illuminator/line_light.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tests/hal/error_check.hpp"
#include "tests/hal/units.hpp"

using namespace compueye;
using hal::ErrorCode;
using illuminator::LineLight;
using illuminator::LineLightSettings;
using test::ms;

namespace {

/// What became of six lines, which outlives whoever sets them.
struct Wire {
  std::vector<std::uint32_t> levels;
  int opened = 0, closed = 0, failing = 0;  ///< so many sets from now on
  bool gone = false;
};

class Lines final : public hal::OutputLines {
 public:
  Lines(Wire& wire, int count) : wire_(wire), count_(count) {}
  [[nodiscard]] const std::string& name() const noexcept override { return name_; }
  [[nodiscard]] int count() const noexcept override { return count_; }
  [[nodiscard]] hal::Result<void> open() override {
    if (wire_.gone) return hal::fail(ErrorCode::not_found, name_, "is no GPIO chip");
    ++wire_.opened;
    wire_.levels.push_back(0);
    return {};
  }
  void close() noexcept override { ++wire_.closed; }
  [[nodiscard]] hal::Result<void> set(std::uint32_t levels) override {
    if (wire_.failing > 0) {
      --wire_.failing;
      return hal::fail(ErrorCode::disconnected, name_, "the chip went away");
    }
    wire_.levels.push_back(levels);
    return {};
  }

 private:
  Wire& wire_;
  int count_;
  std::string name_ = "gpiochip0 lines 5, 6 and more";
};

struct Lamps {
  Wire wire;
  hal::VirtualClock clock{1000 * ms};
  std::unique_ptr<LineLight> light = LineLight::create({2, 3, 4 * ms}, std::make_unique<Lines>(wire, 6), clock).value();
};

}  // namespace

TEST_CASE("lamps on lines: a picture is one call, its first pixel the first line, half of white and more is lit") {
  Lamps lamps;
  CHECK(lamps.light->describe().rows == 2);
  CHECK(lamps.light->describe().cols == 3);
  CHECK(lamps.light->describe().levels == 2);
  CHECK(lamps.wire.levels == std::vector<std::uint32_t>{0});
  const std::vector<float> picture{1.0F, 0.0F, 0.49F, 0.5F, std::nanf(""), 7.0F};
  const auto stable_ns = lamps.light->show(picture);
  REQUIRE(stable_ns);
  CHECK(*stable_ns == 1004 * ms);
  CHECK(lamps.wire.levels.size() == 2);
  CHECK(lamps.wire.levels.back() == 0b101001);
  REQUIRE(lamps.light->off());
  CHECK(lamps.wire.levels.back() == 0);
  REQUIRE(lamps.light->show(std::vector<float>(6, 1.0F)));
  CHECK(lamps.wire.levels.back() == 0b111111);
  const auto other = lamps.light->show(std::vector<float>(5, 1.0F));
  test::check_error(other, ErrorCode::mismatch, "lamps", {"5", "6"});
  CHECK(lamps.wire.levels.size() == 4);
  lamps.light.reset();
  CHECK(lamps.wire.levels.back() == 0);  // nobody leaves them lit
  CHECK(lamps.wire.closed == 1);
}

TEST_CASE("lamps on lines: 32 are set together") {
  Wire wire;
  hal::VirtualClock clock;
  const auto light = LineLight::create({4, 8, 0}, std::make_unique<Lines>(wire, 32), clock).value();
  std::vector<float> picture(32, 0.0F);
  picture.front() = picture.back() = 1.0F;
  REQUIRE(light->show(picture));
  CHECK(wire.levels.back() == 0x80000001U);
}

TEST_CASE("lamps on lines: as many as pixels, or none") {
  hal::VirtualClock clock;
  for (const int count : {0, 1, 5, 7}) {
    Wire wire;
    const auto made = LineLight::create({2, 3, 0}, std::make_unique<Lines>(wire, count), clock);
    test::check_error(made, ErrorCode::unsupported, "gpiochip0 lines 5, 6 and more", {std::to_string(count), "6"});
    CHECK(wire.opened == 0);
  }
}

TEST_CASE("lamps on lines: a chip that was away is asked for its lines again, and one that stays away is an error") {
  Lamps lamps;
  lamps.wire.failing = 1;
  REQUIRE(lamps.light->show(std::vector<float>(6, 1.0F)));
  CHECK(lamps.wire.opened == 2);
  CHECK(lamps.wire.levels.back() == 0b111111);
  lamps.wire.failing = 2;
  CHECK(lamps.light->off().error().code == ErrorCode::disconnected);
  lamps.wire.failing = 1;
  lamps.wire.gone = true;
  CHECK(lamps.light->off().error().code == ErrorCode::not_found);
  lamps.wire.gone = false;
  CHECK(lamps.light->off());
}
