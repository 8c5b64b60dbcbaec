#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "drivers/frontend/front_end.hpp"

namespace compueye::frontend {

/// What FrontEndRow::make refuses of every chip: error out_of_range names the setting and what the chip takes.
/// `frame_bytes`: of one chip.
[[nodiscard]] hal::Result<void> check_settings(const FrontEndRow& row, const FrontEndSettings& settings,
                                               std::size_t frame_bytes);

/// Error usage: there is no line that could choose this chip.
[[nodiscard]] hal::Result<void> select_chip(const Wiring& wiring, std::string_view name, int chip);

/// Low for so long, and then high for so long.
[[nodiscard]] hal::Result<void> pulse_low(hal::OutputLines& line, hal::Clock& clock, std::int64_t low_ns,
                                          std::int64_t high_ns);

/// Something that a chip was asked for while it was configured.
struct ReadBack {
  std::string_view name;  ///< of the chip's kind
  int chip = 0;
  std::string_view what;  ///< the register's name in the datasheet
  std::uint32_t read = 0;
  std::uint32_t expected = 0;
  int bits = 8;                          ///< of the register
  std::uint32_t compared = 0xFFFFFFFFU;  ///< the bits that have to be equal
};

/// Error mismatch: chip, register, what was read, what was expected, and what to look at.
[[nodiscard]] hal::Result<void> check_read_back(const ReadBack& r);

/// As short as it can be read back.
[[nodiscard]] std::string number_text(double value);

[[nodiscard]] bool all_are(std::span<const std::byte> bytes, std::byte value) noexcept;

/// As chips send numbers: the most significant byte first. At most four bytes.
[[nodiscard]] constexpr std::uint32_t load_big(std::span<const std::byte> bytes) noexcept {
  std::uint32_t value = 0;
  for (const std::byte b : bytes) value = value << 8U | std::to_integer<std::uint32_t>(b);
  return value;
}

}  // namespace compueye::frontend
