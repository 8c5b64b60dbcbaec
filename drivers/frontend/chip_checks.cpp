#include "drivers/frontend/chip_checks.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <string>
#include <utility>

#include "hal/try.hpp"

namespace compueye::frontend {
namespace {

constexpr int most_chips = 1024;

std::string hex(std::uint32_t value, int bits) {
  constexpr std::string_view digits = "0123456789ABCDEF";
  std::string text = "0x";
  for (int at = (bits + 3) / 4 - 1; at >= 0; --at) text += digits[value >> (4U * static_cast<unsigned>(at)) & 15U];
  return text;
}

}  // namespace

hal::Result<void> check_settings(const FrontEndRow& row, const FrontEndSettings& settings, std::size_t frame_bytes) {
  const auto refuse = [&](std::string sentence) {
    return hal::fail(hal::ErrorCode::out_of_range, std::string(row.name), std::move(sentence));
  };
  if (settings.chips < 1 || settings.chips > most_chips) {
    return refuse("chips is " + std::to_string(settings.chips) + ", expected 1 to " + std::to_string(most_chips));
  }
  if (settings.clock_hz > row.spi.clock_hz) {
    return refuse("clock_hz is " + std::to_string(settings.clock_hz) + ", and the chip takes at most " +
                  std::to_string(row.spi.clock_hz));
  }
  const int ranges = std::max(1, static_cast<int>(row.ranges.size()));
  if (settings.range < 0 || settings.range >= ranges) {
    return refuse("range is " + std::to_string(settings.range) + ", expected 0 to " + std::to_string(ranges - 1));
  }
  const double bits = 8.0 * static_cast<double>(frame_bytes) * settings.chips;
  const double clock = settings.clock_hz == 0 ? row.spi.clock_hz : settings.clock_hz;
  const double most = std::min(row.most_frames_hz, clock / bits);
  if (!(settings.frame_rate_hz > 0.0 && settings.frame_rate_hz <= most)) {
    return refuse("frame_rate_hz is " + number_text(settings.frame_rate_hz) + ", expected more than 0 and at most " +
                  number_text(most) + ": a chip makes " + number_text(row.most_frames_hz) + " and the clock moves " +
                  number_text(clock / bits) + " of " + std::to_string(settings.chips) + " chips");
  }
  return {};
}

hal::Result<void> select_chip(const Wiring& wiring, std::string_view name, int chip) {
  const int lines = wiring.select == nullptr ? 0 : wiring.select->count();
  if (lines < 32 && (static_cast<std::uint32_t>(chip) >> static_cast<unsigned>(lines)) != 0) {
    return hal::fail(
        hal::ErrorCode::usage, std::string(name) + " chip " + std::to_string(chip),
        "cannot be chosen with " + std::to_string(lines) + " select lines; name more of them or configure fewer chips");
  }
  if (wiring.select == nullptr) return {};
  return wiring.select->set(static_cast<std::uint32_t>(chip));
}

hal::Result<void> pulse_low(hal::OutputLines& line, hal::Clock& clock, std::int64_t low_ns, std::int64_t high_ns) {
  TRY(line.set(0));
  clock.sleep_until_ns(clock.now_ns() + low_ns);
  TRY(line.set(1));
  clock.sleep_until_ns(clock.now_ns() + high_ns);
  return {};
}

hal::Result<void> check_read_back(const ReadBack& r) {
  if (((r.read ^ r.expected) & r.compared) == 0) return {};
  const std::uint32_t ones = r.bits >= 32 ? 0xFFFFFFFFU : (1U << static_cast<unsigned>(r.bits)) - 1U;
  const std::string look = r.read == 0      ? "MISO is low all the time: look for a short to ground, and at chip select"
                           : r.read == ones ? "nothing drives MISO: look at power, chip select and MISO's wire"
                                            : "another chip, or bits get lost: look at wiring, clock and mode";
  return hal::fail(
      hal::ErrorCode::mismatch, std::string(r.name) + " chip " + std::to_string(r.chip),
      std::string(r.what) + " reads " + hex(r.read, r.bits) + ", expected " + hex(r.expected, r.bits) + "; " + look);
}

std::string number_text(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

bool all_are(std::span<const std::byte> bytes, std::byte value) noexcept {
  return std::all_of(bytes.begin(), bytes.end(), [&](std::byte b) { return b == value; });
}

}  // namespace compueye::frontend
