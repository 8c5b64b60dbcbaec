#include "drivers/frontend/ddc264.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "drivers/frontend/chip_checks.hpp"
#include "hal/try.hpp"

namespace compueye::frontend {
namespace {

constexpr std::size_t inputs = 64;
constexpr std::size_t chip_bytes = inputs * 20 / 8;
/// 16 bits an input instead of 20, p. 21: what a chip with a configuration of zeros lacks.
constexpr std::size_t lacking_bytes = inputs * 4 / 8;
/// Chip select is not used, so a frame may be cut anywhere; spidev's buffer is 4096 bytes unless it is told otherwise.
constexpr std::size_t segment_bytes = 4096;

/// From memory of SBAS368C: neither the sheet itself nor a driver could be had to verify it. To be held against pp. 19
/// to 21 and the timing tables before a board is trusted: configure() reads back what was written, but not what it
/// means.
namespace unverified {
// Bits of the configuration register: 13 Clkdiv, 10 .. 9 Range, 8 Format (1: 20 bits), 7 Version, 0 Test.
constexpr unsigned range_shift = 9;
constexpr std::uint16_t format_of_20_bits = 1U << 8U;
constexpr std::array<InputRange, 4> ranges{{{"12.5 pC", 0}, {"50 pC", 1}, {"100 pC", 2}, {"150 pC", 3}}};
// What is read back, table 9, in 20-bit format: 320 zeros, 16 bits of configuration, 4 of revision, 228 zeros, the
// pattern; twice. The vendor's forum has the zeros, the sizes and "twice" (thread 1226979), and the pattern of the
// DDC232 (thread 844097).
constexpr std::size_t copy_bytes = 80;
constexpr std::size_t configuration_at = 40;
constexpr std::size_t pattern_at = 71;
constexpr std::array<std::uint8_t, 9> pattern{0x30, 0xF0, 0x66, 0x01, 0x24, 0x80, 0xF6, 0x90, 0x55};
// Order of the data: the figure of data retrieval begins with the most significant bit of input 64.
constexpr std::size_t place_of(std::size_t input) {
  return inputs - 1 - input;
}
// DCLK's limit, on the safe side; its first bit is there before its first edge.
constexpr hal::SpiMode data_clock{.mode = 0, .clock_hz = 20'000'000};
// Lengths of the reset pulse and of the pauses behind it and behind the configuration; a microsecond or two each.
constexpr std::int64_t reset_low_ns = 10'000;
constexpr std::int64_t reset_high_ns = 10'000;
constexpr std::int64_t after_configuration_ns = 10'000;
}  // namespace unverified

void cut(std::span<std::byte> in, std::vector<hal::SpiSegment>& segments) {
  for (; !in.empty(); in = in.subspan(segments.back().in.size())) {
    segments.push_back({.in = in.first(std::min(in.size(), segment_bytes))});
  }
}

class Ddc264 final : public FrontEnd {
 public:
  explicit Ddc264(const FrontEndSettings& settings)
      : chips_(static_cast<std::size_t>(settings.chips)),
        configuration_(static_cast<std::uint16_t>(unverified::ranges[static_cast<std::size_t>(settings.range)].code
                                                      << unverified::range_shift |
                                                  unverified::format_of_20_bits)),
        in_(chips_ * chip_bytes + 1) {
    cut(in_, segments_);
    exchange_.segments = segments_;
  }

  [[nodiscard]] int channels() const noexcept override { return static_cast<int>(chips_ * inputs); }
  [[nodiscard]] std::span<const Exchange> frame() const noexcept override { return {&exchange_, 1}; }

  [[nodiscard]] hal::Result<void> configure(const Wiring& wiring, hal::Clock& clock) override {
    if (wiring.settings == nullptr || wiring.reset == nullptr) {
      return hal::fail(hal::ErrorCode::usage, std::string(ddc264.name),
                       "needs a bus for DIN_CFG and CLK_CFG, and a line to RESET; name them in the board's wiring");
    }
    // A conversion that ends between writing and reading back takes the place of what is read: CONV goes on meanwhile.
    constexpr int most_tries = 8;
    for (int tries = 1;; ++tries) {
      auto done = set_up(wiring, clock);
      if (done || tries == most_tries || done.error().code != hal::ErrorCode::mismatch) return done;
    }
  }

  [[nodiscard]] FrameReport decode(std::span<std::int32_t> codes, std::span<std::uint8_t> valid) noexcept override {
    FrameReport report;
    const ChipFault of_all = chain_fault();
    for (std::size_t chip = 0; chip < chips_; ++chip) {
      const ChipFault fault = of_all == ChipFault::none ? ChipFault::none : chip_fault(chip, of_all);
      ++report.chips[static_cast<std::size_t>(fault)];
      const bool good = fault == ChipFault::none;
      for (std::size_t input = 0; input < inputs; ++input) {
        codes[chip * inputs + input] = good ? code_of(chip, unverified::place_of(input)) : 0;
        valid[chip * inputs + input] = good ? 1 : 0;
      }
    }
    return report;
  }

 private:
  [[nodiscard]] hal::Result<void> set_up(const Wiring& wiring, hal::Clock& clock) const {
    TRY(pulse_low(*wiring.reset, clock, unverified::reset_low_ns, unverified::reset_high_ns));
    const std::array out{static_cast<std::byte>(configuration_ >> 8U), static_cast<std::byte>(configuration_)};
    const hal::SpiSegment segment{.out = out};
    TRY(wiring.settings->exchange({&segment, 1}));
    clock.sleep_until_ns(clock.now_ns() + unverified::after_configuration_ns);
    std::vector<std::byte> read((chips_ + 1) * chip_bytes);
    std::vector<hal::SpiSegment> segments;
    cut(read, segments);
    TRY(wiring.data->exchange(segments));
    for (std::size_t chip = 0; chip < chips_; ++chip) {
      TRY(check_chip(std::span(read).subspan(chip * chip_bytes, chip_bytes), static_cast<int>(chip)));
    }
    if (all_are(std::span(read).last(chip_bytes), std::byte{0})) return {};
    return hal::fail(hal::ErrorCode::mismatch, std::string(ddc264.name) + " chip " + std::to_string(chips_),
                     "answers behind the " + std::to_string(chips_) +
                         " chips of the board file; name them all, or tie DIN of the last one low");
  }

  /// The configuration first, since it says most.
  [[nodiscard]] hal::Result<void> check_chip(std::span<const std::byte> read, int chip) const {
    const std::uint32_t got = load_big(read.subspan(unverified::configuration_at, 2));
    TRY(check_read_back({.name = ddc264.name,
                         .chip = chip,
                         .what = "the configuration register",
                         .read = got,
                         .expected = configuration_,
                         .bits = 16}));
    std::array<std::uint8_t, chip_bytes> expected{};
    for (std::size_t copy = 0; copy < chip_bytes; copy += unverified::copy_bytes) {
      expected[copy + unverified::configuration_at] = static_cast<std::uint8_t>(configuration_ >> 8U);
      expected[copy + unverified::configuration_at + 1] = static_cast<std::uint8_t>(configuration_);
      for (std::size_t k = 0; k < unverified::pattern.size(); ++k) {
        expected[copy + unverified::pattern_at + k] = unverified::pattern[k];
      }
    }
    for (std::size_t k = 0; k < chip_bytes; ++k) {
      const bool has_revision = k % unverified::copy_bytes == unverified::configuration_at + 2;
      const std::string what = "byte " + std::to_string(k) + " of what is read back";
      TRY(check_read_back({.name = ddc264.name,
                           .chip = chip,
                           .what = what,
                           .read = std::to_integer<std::uint32_t>(read[k]),
                           .expected = expected[k],
                           .compared = has_revision ? 0x0FU : 0xFFU}));
    }
    return {};
  }

  [[nodiscard]] std::span<const std::byte> data() const noexcept { return std::span(in_).first(chips_ * chip_bytes); }

  [[nodiscard]] ChipFault chain_fault() const noexcept {
    if (in_.back() != std::byte{0}) return ChipFault::wrong_place;
    return all_are(data().last(lacking_bytes), std::byte{0}) ? ChipFault::lost_settings : ChipFault::none;
  }

  /// Of a chip in a chain that has a fault: whether the wires behind or at it show one level.
  [[nodiscard]] ChipFault chip_fault(std::size_t chip, ChipFault of_all) const noexcept {
    const auto own = data().subspan(chip * chip_bytes, chip_bytes);
    if (all_are(own, std::byte{0})) return ChipFault::stuck_low;
    if (in_.back() == std::byte{0xFF} && all_are(own, std::byte{0xFF})) return ChipFault::stuck_high;
    return of_all;
  }

  /// Two places share five bytes.
  [[nodiscard]] std::int32_t code_of(std::size_t chip, std::size_t place) const noexcept {
    const std::size_t first_bit = 20 * place;
    const std::uint32_t three = load_big(data().subspan(chip * chip_bytes + first_bit / 8, 3));
    return static_cast<std::int32_t>((first_bit % 8 == 0 ? three >> 4U : three) & 0xFFFFFU);
  }

  std::size_t chips_;
  std::uint16_t configuration_;
  std::vector<std::byte> in_;
  std::vector<hal::SpiSegment> segments_;
  Exchange exchange_;
};

hal::Result<std::unique_ptr<FrontEnd>> make(const FrontEndSettings& settings) {
  TRY(check_settings(ddc264, settings, chip_bytes));
  return std::make_unique<Ddc264>(settings);
}

}  // namespace

const FrontEndRow ddc264{
    .name = "ddc264",
    .title = "Texas Instruments DDC264",
    .datasheet = "SBAS368C",
    .channels = inputs,
    .bits = 20,
    .spi = unverified::data_clock,
    .chain = true,
    .data_ready = true,  // DVALID, p. 21
    .settings_bus = true,
    .most_frames_hz = 6250.0,  // p. 1: integration times from 160 us on
    .ranges = unverified::ranges,
    .make = make,
    .emulate = emulate_ddc264,
};

}  // namespace compueye::frontend
