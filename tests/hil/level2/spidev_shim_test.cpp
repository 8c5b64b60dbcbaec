// What umockdev cannot show of a spidev: who may not open it, that it is closed, and many exchanges in a short time.

#include <doctest/doctest.h>

#include <array>
#include <cerrno>
#include <cstddef>

#include "drivers/transport/spi_spidev.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/hil/spi_shim.hpp"

namespace compueye::hil {
namespace {

using hal::ErrorCode;

constexpr const char* path = "/dev/spidev7.1";
constexpr hal::SpiMode usual{0, 10'000'000};

/// Gives back the complement of what it hears.
class Complement final : public SpiDeviceModel {
 public:
  void transfer(std::span<const hal::SpiSegment> segments) override {
    for (const hal::SpiSegment& each : segments) {
      for (std::size_t k = 0; k < each.in.size(); ++k) each.in[k] = ~each.out[k];
    }
  }
};

TEST_CASE("spi: a bus that may not be opened says who may, and every file that was opened is closed") {
  Complement chip;
  EmulatedSpidev file(chip);
  shim_spidev(path, file);
  {
    transport::SpidevBus bus(path);
    refuse_spidev(EACCES);
    test::check_error(bus.open(usual), ErrorCode::io, path, {"group", "spi"});
    refuse_spidev(EMFILE);
    CHECK(bus.open(usual).error().code == ErrorCode::io);
    refuse_spidev(ENXIO);
    CHECK(bus.open(usual).error().code == ErrorCode::not_found);
    refuse_spidev(0);
    REQUIRE(bus.open(usual));
    REQUIRE(bus.open(usual));
    CHECK(open_spidev_files() == 1);
    bus.close();
    CHECK(open_spidev_files() == 0);
    file.limits.modes = 0;
    CHECK_FALSE(bus.open(usual));
    CHECK(open_spidev_files() == 0);
    file.limits.modes = 0b1111;
    REQUIRE(bus.open(usual));
  }
  CHECK(open_spidev_files() == 0);
}

TEST_CASE("spi: ten thousand frames of eight chips") {
  Complement chip;
  EmulatedSpidev file(chip);
  shim_spidev(path, file);
  transport::SpidevBus bus(path);
  REQUIRE(bus.open(usual));
  constexpr int frames = 10'000;
  std::array<std::byte, 128> out{}, in{};
  std::array<hal::SpiSegment, 8> segments{};
  for (std::size_t k = 0; k < segments.size(); ++k) {
    segments[k] = {std::span(out).subspan(k * 16, 16), std::span(in).subspan(k * 16, 16), true, 0};
  }
  int right = 0;
  for (int frame = 0; frame < frames; ++frame) {
    for (std::size_t k = 0; k < out.size(); ++k) out[k] = static_cast<std::byte>(frame * 31 + static_cast<int>(k));
    if (!bus.exchange(segments)) break;
    bool same = true;
    for (std::size_t k = 0; k < in.size(); ++k) same = same && in[k] == ~out[k];
    right += same ? 1 : 0;
  }
  CHECK(right == frames);
  CHECK(file.counters().messages == frames);
}

}  // namespace
}  // namespace compueye::hil
