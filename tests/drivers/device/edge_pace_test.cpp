// Which frames edges of data-ready are of, against conversions that the test makes itself.

#include "drivers/device/edge_pace.hpp"

#include <doctest/doctest.h>

#include <cstdint>
#include <optional>
#include <random>

#include "tests/hal/units.hpp"

namespace compueye::device {
namespace {

constexpr std::int64_t period_ns = 1'000'000;

/// A converter whose crystal is `ppm` off, and the edges of it that somebody sees.
struct Converter {
  EdgePace pace;
  double ppm = 0.0;
  bool counted = true;
  std::uint64_t conversion = 0, edges = 0;
  std::uint64_t frames = 0, late = 0, unsaid = 0, spurious = 0, estimated = 0, unclear = 0;

  Converter() { pace.begin(period_ns); }
  [[nodiscard]] std::int64_t at(double conversions) const {
    return 5 * test::ms + static_cast<std::int64_t>(conversions * period_ns * (1.0 + ppm * 1e-6));
  }
  bool see(std::int64_t t_ns) {
    const EdgePace::Seen seen = pace.saw({t_ns, counted ? std::optional(++edges) : std::nullopt});
    frames += seen.frame ? 1 : 0;
    unclear += seen.unclear ? 1 : 0;
    late += seen.late;
    unsaid += seen.unsaid;
    spurious += seen.spurious;
    estimated += seen.estimated;
    return seen.frame;
  }
  /// The next conversion's, `late_ns` after it.
  bool next(std::int64_t late_ns = 0) { return see(at(static_cast<double>(conversion++)) + late_ns); }
  /// Frames, whatever became of them.
  [[nodiscard]] std::uint64_t made() const { return frames + late + unsaid; }
};

}  // namespace

TEST_CASE("every edge of a converter in time is a frame, whatever its crystal's error and the edges' delay") {
  std::mt19937 random(1);
  std::uniform_int_distribution<std::int64_t> delay(0, 400'000);
  for (const double ppm : {-5000.0, -100.0, 0.0, 100.0, 5000.0}) {
    Converter chip;
    chip.ppm = ppm;
    for (int k = 0; k < 20'000; ++k) REQUIRE(chip.next(k == 0 ? 0 : delay(random)));
    CHECK(chip.made() == 20'000);
    CHECK(chip.late + chip.unsaid + chip.spurious + chip.estimated == 0);
  }
}

TEST_CASE("edges that the kernel dropped are late frames, edges that never came unsaid ones") {
  Converter chip;
  for (int k = 0; k < 10; ++k) chip.next();
  chip.edges += 7;  // counted and not given
  chip.conversion += 7;
  chip.next();
  CHECK(chip.late == 7);
  chip.conversion += 3;  // not even counted
  chip.next();
  CHECK(chip.unsaid == 3);
  chip.edges += 2;
  chip.conversion += 5;
  chip.next();
  CHECK(chip.late == 9);
  CHECK(chip.unsaid == 6);
  CHECK(chip.made() == chip.conversion);
  CHECK(chip.spurious + chip.estimated == 0);
}

TEST_CASE("without a count time tells what is lost, and says that it is an estimate when it may be wrong") {
  for (const double ppm : {-200.0, 200.0}) {
    Converter chip;
    chip.ppm = ppm;
    chip.counted = false;
    for (int k = 0; k < 10; ++k) chip.next();
    chip.conversion += 900;
    chip.next();
    CHECK(chip.made() == chip.conversion);
    CHECK(chip.unsaid == 900);
    CHECK(chip.estimated == 0);
    chip.conversion += 100'000;
    chip.next();
    CHECK(chip.estimated == chip.unsaid - 900);
    CHECK(chip.made() != chip.conversion);  // which is why
  }
}

TEST_CASE("a count tells what time cannot") {
  for (const double ppm : {-200.0, 200.0}) {
    Converter chip;
    chip.ppm = ppm;
    for (int k = 0; k < 10; ++k) chip.next();
    chip.conversion += 100'000;
    chip.edges += 100'000;
    chip.next();
    CHECK(chip.made() == chip.conversion);
    CHECK(chip.late == 100'000);
    CHECK(chip.estimated == 0);
  }
}

TEST_CASE("an edge that rings is no frame, and neither is a storm of them") {
  Converter chip;
  for (int k = 0; k < 50; ++k) {
    chip.next();
    CHECK_FALSE(chip.see(chip.at(k) + 1'000));
    CHECK_FALSE(chip.see(chip.at(k) + 300'000));
  }
  CHECK(chip.made() == 50);
  CHECK(chip.spurious == 100);
  // An edge every 10 us for 20 periods, of which the kernel gives the first 16 and the last.
  const double begin = static_cast<double>(chip.conversion);
  for (int k = 0; k < 16; ++k) chip.see(chip.at(begin) + 10'000 * k);
  chip.edges += 2000;
  chip.conversion += 20;
  chip.next();
  CHECK(chip.made() == chip.conversion);
  CHECK(chip.frames == 52);
  CHECK(chip.unclear == 1);
  REQUIRE(chip.next());
  CHECK(chip.unclear == 1);
  CHECK(chip.spurious == 100 + 15 + 2000 - 19);
}

TEST_CASE("frames that nobody has seen are those that time has room for") {
  Converter chip;
  CHECK(chip.pace.unseen(1'000'000'000) == 0);
  CHECK_FALSE(chip.pace.next_ns());
  chip.next();
  CHECK(chip.pace.unseen(chip.at(0.9)) == 0);
  CHECK(chip.pace.unseen(chip.at(1.01)) == 1);
  CHECK(chip.pace.unseen(chip.at(7.5)) == 7);
  CHECK(*chip.pace.next_ns() == chip.at(1));
}

}  // namespace compueye::device
