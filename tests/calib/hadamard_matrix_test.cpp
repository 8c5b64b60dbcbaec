#include "calib/patterns/hadamard_matrix.hpp"

#include <doctest/doctest.h>

#include <bit>
#include <cstdint>
#include <set>
#include <vector>

#include "tests/hal/error_check.hpp"

using namespace compueye;
using namespace compueye::calib;
using compueye::test::check_error;

namespace {

/// A row a vector of bits, 1 where the matrix has -1.
std::vector<std::vector<std::uint64_t>> packed(const HadamardMatrix& matrix) {
  const auto n = static_cast<std::size_t>(matrix.order());
  std::vector<std::vector<std::uint64_t>> rows(n, std::vector<std::uint64_t>((n + 63) / 64, 0));
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      const int entry = matrix.at(static_cast<int>(i), static_cast<int>(j));
      REQUIRE((entry == 1 || entry == -1));
      if (entry < 0) rows[i][j / 64] |= std::uint64_t{1} << (j % 64);
    }
  }
  return rows;
}

int differing(const std::vector<std::uint64_t>& a, const std::vector<std::uint64_t>& b) {
  int count = 0;
  for (std::size_t w = 0; w < a.size(); ++w) count += std::popcount(a[w] ^ b[w]);
  return count;
}

/// Pairs of rows whose inner product is not 0.
int not_orthogonal(const HadamardMatrix& matrix) {
  const auto rows = packed(matrix);
  int wrong = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) wrong += 2 * differing(rows[i], rows[j]) == matrix.order() ? 0 : 1;
  }
  return wrong;
}

}  // namespace

TEST_CASE("hadamard: every order up to 256 that is promised is orthogonal, its first row and column all +1") {
  int orders = 0;
  for (int n = 1; n <= 256; ++n) {
    if (!HadamardMatrix::exists(n)) continue;
    CAPTURE(n);
    ++orders;
    const auto matrix = HadamardMatrix::of_order(n);
    REQUIRE(matrix.has_value());
    CHECK(matrix->order() == n);
    CHECK(not_orthogonal(*matrix) == 0);
    int first = 0;
    for (int k = 0; k < n; ++k) first += matrix->at(0, k) + matrix->at(k, 0);
    CHECK(first == 2 * n);
  }
  CHECK(orders == 2 + 64 - 8);  // 1, 2 and the multiples of 4 but eight
}

// OEIS A046116, "orders of Hadamard matrices that are not of Paley's class", which MathWorld lists up to 1000; products
// of two of Paley's add none there.
TEST_CASE("hadamard: the orders up to 1000 that are missing are those that the literature lists") {
  const std::set<int> missing{92,  116, 156, 172, 184, 188, 232, 236, 260, 268, 292, 324, 356, 372,
                              376, 404, 412, 428, 436, 452, 472, 476, 508, 520, 532, 536, 584, 596,
                              604, 612, 652, 668, 712, 716, 732, 756, 764, 772, 808, 836, 852, 856,
                              872, 876, 892, 904, 932, 940, 944, 952, 956, 964, 980, 988, 996};
  std::set<int> found;
  for (int n = 1; n <= 1000; ++n) {
    if (HadamardMatrix::exists(n)) {
      CHECK((n <= 2 || n % 4 == 0));
    } else if (n % 4 == 0) {
      found.insert(n);
    }
  }
  CHECK(found == missing);
  for (const int n : {0, -4, 3, 6, 10}) CHECK_FALSE(HadamardMatrix::exists(n));
}

TEST_CASE("hadamard: fields of prime powers serve as well as those of primes") {
  // 28 = 27 + 1, 52 = 2 (25 + 1), 100 = 2 (49 + 1), 244 = 243 + 1; 240 = 12 x 20 has two of Paley's factors.
  for (const int q : {3, 5, 9, 25, 27, 49, 121, 125, 243}) {
    CAPTURE(q);
    const QuadraticCharacter chi(q);
    int squares = 0, sum_of_products = 0;
    for (int a = 0; a < q; ++a) {
      squares += chi.of_difference(a, 0) == 1 ? 1 : 0;
      for (int shift = 1; shift < q; ++shift) {
        sum_of_products += chi.of_difference(a, 0) * chi.of_difference(a, shift);
        // -1 is a square where q = 1 mod 4.
        CHECK(chi.of_difference(a, shift) == chi.of_difference(shift, a) * (q % 4 == 1 ? 1 : -1));
      }
    }
    CHECK(squares == (q - 1) / 2);
    CHECK(sum_of_products == -(q - 1));  // Jacobsthal: -1 for each shift
  }
  for (const int q : {0, 1, 6, 12, 15, 100, -7}) CHECK_FALSE(prime_power(q).has_value());
  CHECK(prime_power(2)->power == 1);
  CHECK(prime_power(16)->prime == 2);
  CHECK(prime_power(2187)->power == 7);
}

TEST_CASE("hadamard: an order without a matrix is refused with the next one that has") {
  check_error(HadamardMatrix::of_order(92), hal::ErrorCode::out_of_range, "hadamard", {"92", "96"});
  check_error(HadamardMatrix::of_order(0), hal::ErrorCode::out_of_range, "hadamard", {"0", "1"});
  check_error(HadamardMatrix::of_order(HadamardMatrix::largest_order * 2), hal::ErrorCode::out_of_range, "hadamard",
              {"134217728", "67108864"});
  CHECK(HadamardMatrix::order_at_least(257) == 264);
  CHECK(HadamardMatrix::order_at_least(160) == 160);
  CHECK(HadamardMatrix::order_at_least(3) == 4);
}
