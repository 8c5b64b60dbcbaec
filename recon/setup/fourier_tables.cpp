#include "recon/setup/fourier_tables.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>

namespace compueye::recon {
namespace {

/// Coefficient k: 0 the mean, 2 f - 1 and 2 f the cosine and sine of frequency f, and for an even length the last one
/// the alternating sign, whose sine would vanish.
double entry(int length, int k, int r) {
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
    for (int r = 0; r < length; ++r) table.push_back(static_cast<T>(entry(length, k, r)));
  }
  return table;
}

template std::vector<float> make_fourier_table<float>(int length);
template std::vector<double> make_fourier_table<double>(int length);

}  // namespace compueye::recon
