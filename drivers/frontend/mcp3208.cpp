#include "drivers/frontend/mcp3208.hpp"

#include <vector>

#include "drivers/frontend/addressed_front_end.hpp"
#include "drivers/frontend/chip_checks.hpp"
#include "hal/try.hpp"

namespace compueye::frontend {
namespace {

constexpr std::uint32_t inputs = 8;
constexpr std::size_t conversion_bytes = 3;  // DS21298E section 6.1, figure 6-1: three times eight clocks

/// Section 6.1, figure 6-1: five zeros, the start bit, SGL (table 5-2: 1, single-ended), D2 | D1 D0, six that do not
/// matter | eight that do not matter.
constexpr std::byte start_and_single{0x06};
std::vector<std::byte> conversion_of(std::uint32_t input) {
  return {start_and_single | static_cast<std::byte>(input >> 2U), static_cast<std::byte>((input & 3U) << 6U),
          std::byte{0}};
}

/// Section 5.0, figure 5-1: high impedance, which the pull-up makes ones, in the first eleven clocks, the null bit at
/// the twelfth, B11 at the next.
constexpr std::uint32_t marker = 0xFFE;
constexpr std::uint32_t marker_of(std::uint32_t conversion) {
  return conversion >> 12U;
}
constexpr std::uint32_t code_mask = 0xFFF;

class Mcp3208 final : public AddressedFrontEnd {
 public:
  explicit Mcp3208(const FrontEndSettings& settings)
      : AddressedFrontEnd(frontend::mcp3208, settings.chips,
                          {conversion_of(0), conversion_of(1), conversion_of(2), conversion_of(3), conversion_of(4),
                           conversion_of(5), conversion_of(6), conversion_of(7)}) {}

 private:
  /// There is nothing to set: the pattern around the data says whether a chip answers.
  hal::Result<void> configure_chip(hal::SpiBus& bus, hal::Clock& /*clock*/, int chip) override {
    TRY(bus.exchange(segments_of(chip)));
    for (std::uint32_t input = 0; input < inputs; ++input) {
      const std::uint32_t read = load_big(bytes_of(chip).subspan(conversion_bytes * input, conversion_bytes));
      const bool nothing_but_one_level = read == 0 || read == 0xFFFFFF;
      TRY(check_read_back({.name = row().name,
                           .chip = chip,
                           .what = "the null bit's marker",
                           .read = nothing_but_one_level ? read & code_mask : marker_of(read),
                           .expected = marker,
                           .bits = 12}));
    }
    return {};
  }

  ChipFault decode_chip(std::span<const std::byte> in, std::span<std::int32_t> codes) const noexcept override {
    for (std::size_t input = 0; input < inputs; ++input) {
      const std::uint32_t read = load_big(in.subspan(conversion_bytes * input, conversion_bytes));
      if (marker_of(read) != marker) return ChipFault::wrong_place;
      codes[input] = static_cast<std::int32_t>(read & code_mask);
    }
    return ChipFault::none;
  }
};

hal::Result<std::unique_ptr<FrontEnd>> make(const FrontEndSettings& settings) {
  TRY(check_settings(mcp3208, settings, inputs * conversion_bytes));
  return std::make_unique<Mcp3208>(settings);
}

}  // namespace

const FrontEndRow mcp3208{
    .name = "mcp3208",
    .title = "Microchip MCP3208",
    .datasheet = "DS21298E",
    .channels = inputs,
    .bits = 12,
    // Section 1.0, timing: 2 MHz at 5 V, 1 MHz at 2.7 V, which a board says by its own clock. Section 6.1: mode 0.
    .spi = {.mode = 0, .clock_hz = 2'000'000},
    .chain = false,
    .data_ready = false,
    .settings_bus = false,
    .most_frames_hz = 2e6 / 24 / inputs,  // 24 clocks a conversion
    .ranges = {},
    .make = make,
    .emulate = emulate_mcp3208,
};

}  // namespace compueye::frontend
