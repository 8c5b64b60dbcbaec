#pragma once

#include <optional>
#include <vector>

#include "calib/patterns/quadratic_character.hpp"
#include "hal/result.hpp"

namespace compueye::calib {

/// A matrix H of +1 and -1 with H H' = order * I, whose first row and first column are +1. Built of Sylvester's
/// matrices (1867: orders 2^k) and Paley's two (1933, "On orthogonal matrices": q + 1 for a prime power q = 3 mod 4,
/// 2 (q + 1) for one that is 1 mod 4), and Kronecker products of these, with factors as small as they come: 160 is
/// Paley's 20 by Sylvester's 8. Up to 256 that is every multiple of 4 but 92, 116, 156, 172, 184, 188, 232 and 236.
class HadamardMatrix {
 public:
  static constexpr int largest_order = 1 << 26;

  /// Whether these constructions give a matrix of this order (any integer).
  [[nodiscard]] static bool exists(int order);
  /// The least order that exists and is not below n, 1 <= n <= largest_order.
  [[nodiscard]] static int order_at_least(int n);
  /// Error out_of_range names the next order that exists.
  [[nodiscard]] static hal::Result<HadamardMatrix> of_order(int order);

  [[nodiscard]] int order() const noexcept { return order_; }
  /// +1 or -1; 0 <= row, col < order().
  [[nodiscard]] int at(int row, int col) const noexcept;

 private:
  struct Factor {
    int order = 1;
    std::optional<QuadraticCharacter> chi;  ///< Paley's; without: Sylvester's
    bool second = false;                    ///< of Paley's two
  };
  HadamardMatrix() = default;
  [[nodiscard]] static int entry(const Factor& factor, int row, int col) noexcept;

  int order_ = 1;
  std::vector<Factor> factors_;  ///< the last one's indices change fastest
};

}  // namespace compueye::calib
