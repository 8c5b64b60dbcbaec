#include "recon/setup/basis_tables.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>

#include "recon/core/bases/dct.hpp"

namespace compueye::recon {
namespace {

/// Entry (k, r) of the orthonormal DCT-II of `length`. The angle is reduced by integers first, so that long
/// transforms keep their last digits.
double entry(int length, int k, int r) {
  const long long turn = 4LL * length;
  const long long step = (static_cast<long long>(k) * (2LL * r + 1)) % turn;
  const double scale = std::sqrt((k == 0 ? 1.0 : 2.0) / length);
  return scale * std::cos(std::numbers::pi * static_cast<double>(step) / (2.0 * length));
}

}  // namespace

template <class T>
std::vector<T> make_dct_table(int length) {
  std::vector<T> values;
  values.reserve(core::DctTable<T>::size(static_cast<std::size_t>(length)));
  using Table = core::DctTable<T>;
  const auto whole = static_cast<std::size_t>(length);
  int odd = length;
  for (int half = length / 2; odd % 2 == 0; half /= 2) {
    odd = half;
    if (!Table::rotated(static_cast<std::size_t>(half))) continue;
    for (int r = 0; r < half / 2; ++r) {
      values.push_back(static_cast<T>(std::cos(std::numbers::pi * (2.0 * r + 1.0) / (4.0 * half))));
    }
    for (int r = 0; r < half / 2; ++r) {
      values.push_back(static_cast<T>(std::sin(std::numbers::pi * (2.0 * r + 1.0) / (4.0 * half))));
    }
  }
  int n = length;
  int stride = 1;  // coefficient k of the current level is coefficient k * stride of the whole
  while (n % 2 == 0) {
    const int half = n / 2;
    if (Table::dense(static_cast<std::size_t>(half), whole)) {
      for (int k = 0; k < half; ++k) {
        for (int r = 0; r < half; ++r) values.push_back(static_cast<T>(entry(length, (2 * k + 1) * stride, r)));
      }
    }
    n = half;
    stride *= 2;
  }
  // A level's even coefficients are the DCT of mirrored sums, whose sample r sits where the full length has r.
  for (int k = 0; k < n; ++k) {
    for (int r = 0; r < n; ++r) values.push_back(static_cast<T>(entry(length, k * stride, r)));
  }
  return values;
}

template std::vector<float> make_dct_table<float>(int length);
template std::vector<double> make_dct_table<double>(int length);

namespace {

/// Coefficient k: 0 the mean, 2 f - 1 and 2 f the cosine and sine of frequency f, and for an even length the last one
/// the alternating sign, whose sine would vanish.
double fourier_entry(int length, int k, int r) {
  const int frequency = (k + 1) / 2;
  const bool unpaired = k == 0 || 2 * frequency == length;
  const double scale = std::sqrt((unpaired ? 1.0 : 2.0) / length);
  const long long step = static_cast<long long>(frequency) * r % length;
  const double angle = 2.0 * std::numbers::pi * static_cast<double>(step) / length;
  return scale * (k % 2 == 1 || k == 0 ? std::cos(angle) : std::sin(angle));
}

}  // namespace

template <class T>
std::vector<T> make_fourier_table(int length) {
  std::vector<T> table;
  table.reserve(static_cast<std::size_t>(length) * static_cast<std::size_t>(length));
  for (int k = 0; k < length; ++k) {
    for (int r = 0; r < length; ++r) table.push_back(static_cast<T>(fourier_entry(length, k, r)));
  }
  return table;
}

template std::vector<float> make_fourier_table<float>(int length);
template std::vector<double> make_fourier_table<double>(int length);

std::vector<double> smoothing_eigenvalues(int image_rows, int image_cols) {
  std::vector<double> eigenvalues;
  for (int i = 0; i < image_rows; ++i) {
    const double down = 2.0 - 2.0 * std::cos(std::numbers::pi * i / image_rows);
    for (int k = 0; k < image_cols; ++k) {
      eigenvalues.push_back(1.0 + down + 2.0 - 2.0 * std::cos(std::numbers::pi * k / image_cols));
    }
  }
  return eigenvalues;
}

}  // namespace compueye::recon
