#include "calib/patterns/hadamard_matrix.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <string>
#include <utility>

namespace compueye::calib {
namespace {

bool is_power_of_two(int n) noexcept {
  return n >= 1 && std::has_single_bit(static_cast<unsigned>(n));
}

/// The field behind Paley's matrix of this order; 0 where there is none.
int paley_field(int order) noexcept {
  if (order % 4 != 0) return 0;
  if (prime_power(order - 1)) return order - 1;
  const int half = order / 2 - 1;
  return half % 4 == 1 && prime_power(half) ? half : 0;
}

/// Orders whose product is `order`, Paley's first and ascending; empty where there are none. Paley's orders are
/// multiples of 4, so what is left over must be one, 2 or 1.
std::vector<int> factor_orders(int order, int at_least = 4) {
  if (is_power_of_two(order)) return {order};
  if (order < 1 || order % 4 != 0) return {};
  for (std::int64_t first = at_least; first * first <= order; first += 4) {
    const int paley = static_cast<int>(first);
    if (order % paley != 0 || is_power_of_two(paley) || paley_field(paley) == 0) continue;
    if (auto rest = factor_orders(order / paley, paley); !rest.empty()) {
      rest.insert(rest.begin(), paley);
      return rest;
    }
  }
  // One factor of Paley's above the root, or all of it: the rest is Sylvester's.
  const int twos = 1 << std::countr_zero(static_cast<unsigned>(order));
  for (int sylvester = twos / 4; sylvester >= 1; sylvester /= 2) {
    const int paley = order / sylvester;
    if (paley >= at_least && paley_field(paley) != 0) return {paley, sylvester};
  }
  return {};
}

/// Paley's matrix before its first row and column are made +1.
int paley_entry(const QuadraticCharacter& chi, int row, int col) noexcept {
  if (row == 0 || col == 0) return col == 0 && row > 0 ? -1 : 1;
  return row == col ? 1 : chi.of_difference(row - 1, col - 1);
}

/// His second one: a symmetric conference matrix by (1 1; 1 -1), its empty diagonal by (1 -1; -1 -1).
int second_paley_entry(const QuadraticCharacter& chi, int row, int col) noexcept {
  const int i = row / 2, j = col / 2, a = row % 2, b = col % 2;
  if (i == j) return a == 0 && b == 0 ? 1 : -1;
  const int conference = i == 0 || j == 0 ? 1 : chi.of_difference(i - 1, j - 1);
  return a == 1 && b == 1 ? -conference : conference;
}

}  // namespace

bool HadamardMatrix::exists(int order) {
  return !factor_orders(order).empty();
}

int HadamardMatrix::order_at_least(int n) {
  while (!exists(n)) ++n;
  return n;
}

hal::Result<HadamardMatrix> HadamardMatrix::of_order(int order) {
  const auto orders = factor_orders(order);
  if (orders.empty() || order > largest_order) {
    const int next = order_at_least(std::clamp(order, 1, largest_order));
    return hal::fail(hal::ErrorCode::out_of_range, "hadamard",
                     "no matrix of order " + std::to_string(order) + " is made of Sylvester's and Paley's; " +
                         (order > next ? "the largest is " : "the next is ") + std::to_string(next));
  }
  HadamardMatrix made;
  made.order_ = order;
  for (const int each : orders) {
    Factor factor;
    factor.order = each;
    if (!is_power_of_two(each)) {
      const int q = paley_field(each);
      factor.chi.emplace(q);
      factor.second = q != each - 1;
    }
    made.factors_.push_back(std::move(factor));
  }
  return made;
}

int HadamardMatrix::entry(const Factor& factor, int row, int col) noexcept {
  if (!factor.chi) return std::popcount(static_cast<unsigned>(row & col)) % 2 == 0 ? 1 : -1;
  const auto raw = factor.second ? second_paley_entry : paley_entry;
  return raw(*factor.chi, row, col) * raw(*factor.chi, row, 0) * raw(*factor.chi, 0, col) * raw(*factor.chi, 0, 0);
}

int HadamardMatrix::at(int row, int col) const noexcept {
  int product = 1;
  for (auto factor = factors_.rbegin(); factor != factors_.rend(); ++factor) {
    product *= entry(*factor, row % factor->order, col % factor->order);
    row /= factor->order;
    col /= factor->order;
  }
  return product;
}

}  // namespace compueye::calib
