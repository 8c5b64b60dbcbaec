#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace compueye::calib {

/// q = prime^power.
struct PrimePower {
  int prime = 0;
  int power = 0;
};

/// Nothing where q (any integer) is no power of one prime.
[[nodiscard]] std::optional<PrimePower> prime_power(int q) noexcept;

/// chi of the finite field of q elements: 0 for 0, +1 for squares, -1 for all others. An element is the integer
/// 0 .. q - 1 whose digits to the base `prime` are the coefficients of its polynomial.
class QuadraticCharacter {
 public:
  /// q: an odd prime power.
  explicit QuadraticCharacter(int q);

  /// chi(a - b).
  [[nodiscard]] int of_difference(int a, int b) const noexcept;

 private:
  PrimePower field_;
  std::vector<std::int8_t> chi_;
};

}  // namespace compueye::calib
