#include "calib/patterns/quadratic_character.hpp"

#include <cstddef>

namespace compueye::calib {
namespace {

/// Multiplication by x modulo a monic polynomial x^k - remainder(x).
class TimesX {
 public:
  TimesX(int q, int prime, int remainder) : q_(q), prime_(prime), top_(q / prime), remainder_(remainder) {}

  [[nodiscard]] int operator()(int element) const noexcept {
    const int carried = element / top_;
    int shifted = (element % top_) * prime_, rest = remainder_, sum = 0;
    for (int place = 1; place < q_; place *= prime_, shifted /= prime_, rest /= prime_) {
      const auto digit = shifted % prime_ + std::int64_t{carried} * (rest % prime_);
      sum += static_cast<int>(digit % prime_) * place;
    }
    return sum;
  }

  /// Whether the powers of x are all elements but 0, so that the squares among them are the even powers.
  [[nodiscard]] bool generates() const noexcept {
    int element = 1;
    for (int power = 1; power < q_ - 1; ++power) {
      element = (*this)(element);
      if (element <= 1) return false;
    }
    return (*this)(element) == 1;
  }

 private:
  int q_, prime_, top_, remainder_;
};

TimesX generator_of(int q, int prime) {
  int remainder = 1;
  while (!TimesX(q, prime, remainder).generates()) ++remainder;
  return {q, prime, remainder};
}

}  // namespace

std::optional<PrimePower> prime_power(int q) noexcept {
  if (q < 2) return std::nullopt;
  int prime = 2;
  while (std::int64_t{prime} * prime <= q && q % prime != 0) ++prime;
  if (q % prime != 0) prime = q;
  PrimePower found{prime, 0};
  for (; q % prime == 0; q /= prime) ++found.power;
  return q == 1 ? std::optional(found) : std::nullopt;
}

QuadraticCharacter::QuadraticCharacter(int q)
    : field_(prime_power(q).value_or(PrimePower{})), chi_(static_cast<std::size_t>(q), 0) {
  const TimesX next = generator_of(q, field_.prime);
  int element = 1;
  for (int power = 0; power < q - 1; ++power, element = next(element)) {
    chi_[static_cast<std::size_t>(element)] = power % 2 == 0 ? 1 : -1;
  }
}

int QuadraticCharacter::of_difference(int a, int b) const noexcept {
  int difference = 0;
  for (int place = 1, k = 0; k < field_.power; ++k, place *= field_.prime) {
    const int digit = a % field_.prime - b % field_.prime;
    difference += (digit < 0 ? digit + field_.prime : digit) * place;
    a /= field_.prime;
    b /= field_.prime;
  }
  return chi_[static_cast<std::size_t>(difference)];
}

}  // namespace compueye::calib
