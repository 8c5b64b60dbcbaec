#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "hal/image.hpp"
#include "hal/result.hpp"

namespace compueye::calib {

/// Pictures that are put before an eye to measure its response. A pattern is told by (family, seed, index) alone: the
/// same bits on every platform, by integers or correctly rounded arithmetic.
struct PatternFamily {
  std::string_view name;
  std::string_view description;
  bool seeded = false;  ///< whether the seed changes anything
  /// How many patterns there are for a picture of rows x cols: index runs from 0 to one less.
  std::int64_t (*count)(int rows, int cols) = nullptr;
  /// For rows, cols and index that draw() has checked.
  hal::Image (*paint)(int rows, int cols, std::uint64_t seed, std::int64_t index) = nullptr;

  /// Linear intensities 0..1, rows x cols. Errors: out_of_range (a side below 1, more than `most_pattern_pixels`, or
  /// an index beyond count(): the sentence names the range).
  [[nodiscard]] hal::Result<hal::Image> draw(int rows, int cols, std::uint64_t seed, std::int64_t index) const;
};

inline constexpr std::int64_t most_pattern_pixels = std::int64_t{1} << 24;
/// count() of a family that never ends.
inline constexpr std::int64_t any_number_of_patterns = std::int64_t{1} << 31;

/// Every family there is.
[[nodiscard]] std::span<const PatternFamily> pattern_families() noexcept;

/// Error not_found names the nearest family and all others.
[[nodiscard]] hal::Result<const PatternFamily*> pattern_family(std::string_view name);

}  // namespace compueye::calib
