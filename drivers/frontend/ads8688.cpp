#include "drivers/frontend/ads8688.hpp"

#include <array>
#include <vector>

#include "drivers/frontend/addressed_front_end.hpp"
#include "drivers/frontend/chip_checks.hpp"
#include "hal/try.hpp"

namespace compueye::frontend {
namespace {

constexpr std::size_t inputs = 8;
constexpr std::size_t command_bytes = 2;     // SBAS582C section 8.5.1: a command is complete after 16 clocks
constexpr std::size_t conversion_bytes = 6;  // 16 + 25 clocks, p. 50 table 13
constexpr std::size_t frame_bytes = command_bytes + inputs * conversion_bytes;

// Section 8.5.1, table of the command register.
constexpr std::byte reset_command{0x85};      // 8500h: program registers to their defaults
constexpr std::byte auto_sequence{0xA0};      // A000h: the next frame is the first channel's
constexpr std::byte continue_sequence{0x00};  // 0000h: NO_OP

/// Section 8.5.2: 7 bits of address, then 1 to write.
struct ProgramRegister {
  std::uint8_t address;
  std::string_view name;
  std::uint8_t value;
};

// Bits 2 .. 0 of Feature Select, p. 50 table 13: result, channel, device and range. Bits 7 .. 6: the device's number,
// which only chips that are chained need, and which here keeps the tail from being all zeros.
constexpr std::uint32_t sdo_format = 3;
constexpr std::uint32_t device = 1;

std::array<ProgramRegister, 3 + inputs> registers(std::uint8_t range) {
  return {{
      {0x01, "AUTO_SEQ_EN", 0xFF},         // every channel
      {0x02, "Channel Power Down", 0x00},  // none
      {0x03, "Feature Select", static_cast<std::uint8_t>(device << 6U | sdo_format)},
      {0x05, "Channel 0 Input Range", range},
      {0x06, "Channel 1 Input Range", range},
      {0x07, "Channel 2 Input Range", range},
      {0x08, "Channel 3 Input Range", range},
      {0x09, "Channel 4 Input Range", range},
      {0x0A, "Channel 5 Input Range", range},
      {0x0B, "Channel 6 Input Range", range},
      {0x0C, "Channel 7 Input Range", range},
  }};
}

// Section 8.5.2.3.3, table of the range select registers, with the internal reference of 4.096 V.
constexpr std::array<InputRange, 5> ranges{{
    {"-10.24..10.24 V", 0},
    {"-5.12..5.12 V", 1},
    {"-2.56..2.56 V", 2},
    {"0..10.24 V", 5},
    {"0..5.12 V", 6},
}};

/// P. 50 table 14: what follows a result in 16 bits, the last seven of which are zeros.
constexpr std::uint32_t tail_of(std::uint32_t input, std::uint32_t of_device, std::uint32_t range) {
  return input << 12U | of_device << 10U | range << 7U;
}
constexpr std::uint32_t settings_bits = tail_of(0, 3, 7);

/// RST/PD, section 8.4.1.1.6: a longer low than 400 ns, and a GPIO line's is longer, powers down and resets; after it
/// the reference takes 15 ms.
constexpr std::int64_t pin_low_ns = 10'000;
constexpr std::int64_t power_up_ns = 15'000'000;

std::vector<std::byte> no_op() {
  return std::vector<std::byte>(conversion_bytes, continue_sequence);
}

class Ads8688 final : public AddressedFrontEnd {
 public:
  explicit Ads8688(const FrontEndSettings& settings)
      : AddressedFrontEnd(
            frontend::ads8688, settings.chips,
            {{auto_sequence, std::byte{0}}, no_op(), no_op(), no_op(), no_op(), no_op(), no_op(), no_op(), no_op()}),
        range_(static_cast<std::uint8_t>(ranges[static_cast<std::size_t>(settings.range)].code)) {}

 private:
  hal::Result<void> reset_pin(hal::OutputLines& line, hal::Clock& clock) override {
    return pulse_low(line, clock, pin_low_ns, power_up_ns);
  }

  hal::Result<void> configure_chip(hal::SpiBus& bus, hal::Clock& /*clock*/, int chip) override {
    const std::array reset{reset_command, std::byte{0}};
    const hal::SpiSegment segment{.out = reset};
    TRY(bus.exchange({&segment, 1}));
    for (const ProgramRegister& r : registers(range_)) TRY(access(bus, chip, r, true));
    for (const ProgramRegister& r : registers(range_)) TRY(access(bus, chip, r, false));
    return {};
  }

  /// Written or read, the third byte that comes back is the register's, figures of section 8.5.2.1.
  hal::Result<void> access(hal::SpiBus& bus, int chip, const ProgramRegister& r, bool write) const {
    const std::array out{static_cast<std::byte>(static_cast<unsigned>(r.address) << 1U | (write ? 1U : 0U)),
                         static_cast<std::byte>(write ? r.value : 0), std::byte{0}};
    std::array<std::byte, 3> in{};
    const hal::SpiSegment segment{.out = out, .in = in};
    TRY(bus.exchange({&segment, 1}));
    return check_read_back({.name = row().name,
                            .chip = chip,
                            .what = r.name,
                            .read = load_big(std::span(in).last(1)),
                            .expected = r.value});
  }

  ChipFault decode_chip(std::span<const std::byte> in, std::span<std::int32_t> codes) const noexcept override {
    ChipFault fault = ChipFault::none;
    for (std::size_t input = 0; input < inputs; ++input) {
      const auto conversion = in.subspan(command_bytes + input * conversion_bytes, conversion_bytes);
      const std::uint32_t tail = load_big(conversion.last(2));
      const std::uint32_t difference = tail ^ tail_of(static_cast<std::uint32_t>(input), device, range_);
      if (tail == 0) return ChipFault::lost_settings;  // idle after a start, or format 000: no tail
      if ((difference & ~settings_bits) != 0) fault = ChipFault::wrong_place;
      if (difference != 0 && fault == ChipFault::none) fault = ChipFault::lost_settings;
      codes[input] = static_cast<std::int32_t>(load_big(conversion.subspan(2, 2)));
    }
    return fault;
  }

  std::uint8_t range_;
};

hal::Result<std::unique_ptr<FrontEnd>> make(const FrontEndSettings& settings) {
  TRY(check_settings(ads8688, settings, frame_bytes));
  return std::make_unique<Ads8688>(settings);
}

}  // namespace

const FrontEndRow ads8688{
    .name = "ads8688",
    .title = "Texas Instruments ADS8688",
    .datasheet = "SBAS582C",
    .channels = inputs,
    .bits = 16,
    // Section 7.6, timing: data are taken at the clock's falling edge, 17 MHz.
    .spi = {.mode = 1, .clock_hz = 17'000'000},
    .chain = false,
    .data_ready = false,
    .settings_bus = false,
    .most_frames_hz = 500e3 / (inputs + 1),  // 500 kS/s; the frame that starts the sequence converts too
    .ranges = ranges,
    .make = make,
    .emulate = emulate_ads8688,
};

}  // namespace compueye::frontend
