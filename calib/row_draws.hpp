#pragma once

#include <cstdint>

namespace compueye::calib {

/// Random numbers of one row of a response. Counter-based (SplitMix64: Steele, Lea & Flood 2014, "Fast splittable
/// pseudorandom number generators"), so a row draws the same whatever other rows draw, and integer arithmetic up to one
/// exact conversion, so every platform draws the same bits.
class RowDraws {
 public:
  RowDraws(std::uint64_t seed, std::uint32_t row) noexcept : counter_(mixed(mixed(seed) + row)) {}

  [[nodiscard]] std::uint64_t next_bits() noexcept { return mixed(counter_ += 0x9E3779B97F4A7C15U); }

  /// 0 <= u < 1, 53 bits.
  [[nodiscard]] double uniform() noexcept { return static_cast<double>(next_bits() >> 11) * 0x1p-53; }

  /// Mean 0, standard deviation 1, within 6 of the mean: a sum of twelve uniform numbers of 16 bits, which needs no
  /// logarithm from the platform.
  [[nodiscard]] double normal() noexcept {
    std::uint64_t sum = 0;
    for (int draw = 0; draw < 3; ++draw) {
      for (std::uint64_t bits = next_bits(), part = 0; part < 4; ++part, bits >>= 16) sum += bits & 0xFFFFU;
    }
    return (static_cast<double>(sum) + 6.0) * 0x1p-16 - 6.0;
  }

 private:
  [[nodiscard]] static std::uint64_t mixed(std::uint64_t z) noexcept {
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBU;
    return z ^ (z >> 31);
  }

  std::uint64_t counter_;
};

}  // namespace compueye::calib
