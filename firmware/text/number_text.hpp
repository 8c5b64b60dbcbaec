#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace compueye::firmware {

/// Numbers for people. NaN is "n/a" (not measured), infinity "inf" or "-inf"; never an empty cell.

/// With a fixed number of decimals (0..17): fixed(3.14159, 2) = "3.14". Never "-0.00".
[[nodiscard]] std::string fixed(double value, int decimals);

/// With `digits` (1..17) significant digits, in exponent form outside 1e-4 .. 1e6: significant(1.2e-21, 2) = "1.2e-21".
[[nodiscard]] std::string significant(double value, int digits);

/// Thousands set apart: 9010124 -> "9,010,124".
[[nodiscard]] std::string grouped(std::int64_t value);

/// A span of time for people who wait: "0.4 s", "12 s", "3 min 05 s", "2 h 07 min", "n/a" for NaN, infinite or
/// negative.
[[nodiscard]] std::string duration(double seconds);

/// Bytes in binary units with three significant digits: "512 B", "1.50 KiB", "415 MiB".
[[nodiscard]] std::string bytes(std::uint64_t count);

// Numbers as people type them: nothing when the text is anything else, in part or as a whole.

/// A finite decimal number, "0.5", "-3", "1e-6".
[[nodiscard]] std::optional<double> typed_number(std::string_view text) noexcept;
[[nodiscard]] std::optional<std::int64_t> typed_whole_number(std::string_view text) noexcept;

}  // namespace compueye::firmware
