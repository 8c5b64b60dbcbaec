#include "drivers/frontend/ads131m08.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "drivers/frontend/addressed_front_end.hpp"
#include "drivers/frontend/chip_checks.hpp"
#include "drivers/frontend/chip_emulator.hpp"
#include "drivers/protocol/crc16.hpp"
#include "hal/try.hpp"

namespace compueye::frontend {
namespace {

constexpr std::size_t inputs = 8;
constexpr std::size_t word_bytes = 3;                // SBAS950 section 8.5.1.6: 24 bits after reset
constexpr std::size_t frame_words = 1 + inputs + 1;  // section 8.5.1.7: status, channels, CRC
constexpr std::size_t frame_bytes = frame_words * word_bytes;
constexpr std::size_t crc_at = (1 + inputs) * word_bytes;  // section 8.5.1.8: over all words before it, seed FFFFh
using FrameBytes = std::array<std::byte, frame_bytes>;

// Section 8.5.1.10, table of commands, in the upper 16 bits of the first word. The answer is the next frame's first.
constexpr std::uint32_t null_command = 0x0000;
constexpr std::uint32_t reset_command = 0x0011;
constexpr std::uint32_t reset_answer = 0xFF28;
constexpr std::uint32_t read_command(std::uint32_t address) {  // 101a aaaa annn nnnn
  return 0xA000U | address << 7U;
}
constexpr std::uint32_t write_command(std::uint32_t address) {  // 011a aaaa annn nnnn
  return 0x6000U | address << 7U;
}
constexpr std::uint32_t write_answer(std::uint32_t address) {  // 010a aaaa ammm mmmm
  return 0x4000U | address << 7U;
}

// Section 8.6, the register map.
constexpr std::uint32_t id_register = 0x00;
constexpr std::uint32_t id_of_this_chip = 0x2800;  // bits 15 .. 8; the others are reserved
constexpr std::uint32_t id_bits = 0xFF00;

struct Register {
  std::uint32_t address;
  std::string_view name;
  std::uint32_t value;
};

/// STATUS, whose copy is each frame's first word: bit 15 LOCK, 11 CRC_TYPE, 10 RESET and 9 .. 8 WLENGTH are as they
/// were set; 7 .. 0 say which channels have converted since the last frame.
constexpr std::uint32_t status_settings = 0x8F00;
constexpr std::uint32_t status_as_set = 0x0100;
constexpr std::uint32_t status_data_ready = 0x00FF;

/// MODE as after reset, 0510h, but with bit 10, RESET, cleared: what says later that the chip started anew.
constexpr std::uint32_t mode_value = 0x0110;
/// CLOCK: bits 15 .. 8 every channel on, 4 .. 2 OSR, 1 .. 0 high resolution, which 8.192 MHz takes.
constexpr std::uint32_t clock_value(std::uint32_t osr_code) {
  return 0xFF02U | osr_code << 2U;
}

/// CLOCK bits 4 .. 2 by their value, and the data rate: half of fCLKIN over OSR, section 8.3.8.
constexpr double clkin_hz = 8.192e6;
constexpr std::array<int, 8> oversampling{128, 256, 512, 1024, 2048, 4096, 8192, 16256};
double rate_of(int osr) {
  return clkin_hz / 2 / osr;
}

/// GAIN1 and GAIN2: four bits a channel, the full scale being 1.2 V over the gain, section 8.3.4.
constexpr std::array<InputRange, 8> ranges{{
    {"-1.2..1.2 V", 0},
    {"-600..600 mV", 1},
    {"-300..300 mV", 2},
    {"-150..150 mV", 3},
    {"-75..75 mV", 4},
    {"-37.5..37.5 mV", 5},
    {"-18.75..18.75 mV", 6},
    {"-9.375..9.375 mV", 7},
}};
constexpr std::uint32_t gain_of_four = 0x1111;

// Section 6.6: a pin that is low for 2048 clocks resets, and the registers can be read 5 us later; the clock itself may
// need 250 us to run.
constexpr std::int64_t pin_low_ns = 300'000;
constexpr std::int64_t pin_high_ns = 300'000;
constexpr std::int64_t command_reset_ns = 10'000;

std::uint32_t word(std::span<const std::byte> frame, std::size_t index) {
  return load_big(frame.subspan(index * word_bytes, word_bytes));
}

void store_word(FrameBytes& frame, std::size_t index, std::uint32_t upper) {
  frame[index * word_bytes] = static_cast<std::byte>(upper >> 8U);
  frame[index * word_bytes + 1] = static_cast<std::byte>(upper);
}

class Ads131m08 final : public AddressedFrontEnd {
 public:
  Ads131m08(const FrontEndSettings& settings, std::uint32_t osr_code)
      : AddressedFrontEnd(frontend::ads131m08, settings.chips, {std::vector<std::byte>(frame_bytes)}),
        osr_code_(osr_code),
        gain_(ranges[static_cast<std::size_t>(settings.range)].code * gain_of_four) {}

 private:
  hal::Result<void> reset_pin(hal::OutputLines& line, hal::Clock& clock) override {
    return pulse_low(line, clock, pin_low_ns, pin_high_ns);
  }

  hal::Result<void> configure_chip(hal::SpiBus& bus, hal::Clock& clock, int chip) override {
    TRY(command(bus, reset_command));
    clock.sleep_until_ns(clock.now_ns() + command_reset_ns);
    TRY(expect(chip, "the answer to RESET", TRY(command(bus, null_command)), reset_answer));
    TRY(command(bus, read_command(id_register)));
    TRY(expect(chip, "ID", TRY(command(bus, null_command)), id_of_this_chip, id_bits));
    const std::array<Register, 4> registers{{
        {0x03, "CLOCK", clock_value(osr_code_)},
        {0x04, "GAIN1", gain_},
        {0x05, "GAIN2", gain_},
        {0x02, "MODE", mode_value},
    }};
    for (const Register& r : registers) {
      TRY(command(bus, write_command(r.address), r.value));
      TRY(expect(chip, std::string("the answer to writing ") + std::string(r.name),
                 TRY(command(bus, read_command(r.address))), write_answer(r.address)));
      TRY(expect(chip, r.name, TRY(command(bus, null_command)), r.value));
    }
    return {};
  }

  [[nodiscard]] hal::Result<void> expect(int chip, std::string_view what, std::uint32_t read, std::uint32_t expected,
                                         std::uint32_t compared = 0xFFFF) const {
    return check_read_back({.name = row().name,
                            .chip = chip,
                            .what = what,
                            .read = read,
                            .expected = expected,
                            .bits = 16,
                            .compared = compared});
  }

  /// A whole frame, which RESET needs; the answer to the command before this one.
  [[nodiscard]] static hal::Result<std::uint32_t> command(hal::SpiBus& bus, std::uint32_t code,
                                                          std::uint32_t value = 0) {
    FrameBytes out{}, in{};
    store_word(out, 0, code);
    store_word(out, 1, value);
    const hal::SpiSegment segment{.out = out, .in = in};
    TRY(bus.exchange({&segment, 1}));
    return word(in, 0) >> 8U;
  }

  ChipFault decode_chip(std::span<const std::byte> in, std::span<std::int32_t> codes) const noexcept override {
    // The CRC's word with the zeros behind it, section 8.5.1.6: in a word of 24 bits it stands in the upper 16.
    if (word(in, frame_words - 1) != std::uint32_t{protocol::crc16(in.first(crc_at))} << 8U) {
      return ChipFault::crc_error;
    }
    const std::uint32_t status = word(in, 0) >> 8U;
    if ((status & status_settings) != status_as_set) return ChipFault::lost_settings;
    if ((status & status_data_ready) != status_data_ready) return ChipFault::no_new_sample;
    for (std::size_t input = 0; input < inputs; ++input) {
      codes[input] = static_cast<std::int32_t>(word(in, 1 + input) ^ 0x800000U);  // two's complement, section 8.5.1.9
    }
    return ChipFault::none;
  }

  std::uint32_t osr_code_;
  std::uint32_t gain_;
};

hal::Result<std::unique_ptr<FrontEnd>> make(const FrontEndSettings& settings) {
  TRY(check_settings(ads131m08, settings, frame_bytes));
  const auto distance = [&](int osr) { return std::abs(rate_of(osr) - settings.frame_rate_hz); };
  const auto* const nearest = std::min_element(oversampling.begin(), oversampling.end(),
                                               [&](int a, int b) { return distance(a) < distance(b); });
  // 251.97 Hz has no end as a decimal number, and nobody can write it otherwise than rounded.
  constexpr double rounding = 1e-4;
  if (distance(*nearest) > rounding * rate_of(*nearest)) {
    return hal::fail(hal::ErrorCode::out_of_range, std::string(ads131m08.name),
                     "frame_rate_hz is " + number_text(settings.frame_rate_hz) + ", which is none of the chip's own; " +
                         number_text(rate_of(*nearest)) + " is the nearest");
  }
  return std::make_unique<Ads131m08>(settings, static_cast<std::uint32_t>(nearest - oversampling.begin()));
}

}  // namespace

const FrontEndRow ads131m08{
    .name = "ads131m08",
    .title = "Texas Instruments ADS131M08",
    .datasheet = "SBAS950",
    .channels = inputs,
    .bits = 24,
    .spi = {.mode = 1, .clock_hz = 25'000'000},  // section 6.6
    .chain = false,
    .data_ready = true,
    .settings_bus = false,
    .most_frames_hz = clkin_hz / 2 / oversampling.front(),
    .ranges = ranges,
    .make = make,
    .emulate = [] { return emulate_ads131m08(id_of_this_chip); },
};

}  // namespace compueye::frontend
