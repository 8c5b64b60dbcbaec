#include "recon/setup/factor_check.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "recon/setup/leading_modes.hpp"

namespace compueye::recon {
namespace {

constexpr double most_residual = 0.05;
// Of a mode's length squared, which rounding leaves 1e-6 of; frames diverge of modes that are 5e-4 too long.
constexpr double most_stretch = 1e-4;

std::vector<double> drawn(std::size_t count) {
  std::mt19937_64 draw(31);
  std::vector<double> values(count);
  for (double& v : values) v = static_cast<double>(draw() >> 11U) * 0x1p-53 - 0.5;
  return values;
}

double squared(const std::vector<double>& v) {
  double sum = 0.0;
  for (const double each : v) sum += each * each;
  return sum;
}

/// ||a - b||^2 <= most_residual^2 ||b||^2
bool near(const std::vector<double>& a, const std::vector<double>& b) {
  double off = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) off += (a[k] - b[k]) * (a[k] - b[k]);
  return off <= most_residual * most_residual * squared(b);
}

/// A class's vector over all rows of A.
void add_to_rows(const ParityClasses& classes, std::size_t c, const std::vector<double>& of_class,
                 std::vector<double>& rows) {
  for (int m = 0; m < classes.rows(); ++m) {
    const int at = classes.index(c, m);
    if (at >= 0) rows[static_cast<std::size_t>(m)] += classes.share(c, m) * of_class[static_cast<std::size_t>(at)];
  }
}

/// U c of `count` modes of `order` entries, row-major.
std::vector<double> combined(std::span<const float> vectors, const std::vector<double>& c, std::size_t order) {
  std::vector<double> sum(order, 0.0);
  for (std::size_t p = 0; p < order; ++p) {
    for (std::size_t k = 0; k < c.size(); ++k) sum[p] += static_cast<double>(vectors[p * c.size() + k]) * c[k];
  }
  return sum;
}

double inner(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

/// v - U U'v
void leave_out(std::span<const float> vectors, std::size_t count, std::vector<double>& v) {
  std::vector<double> along(count, 0.0);
  for (std::size_t p = 0; p < v.size(); ++p) {
    for (std::size_t k = 0; k < count; ++k) along[k] += static_cast<double>(vectors[p * count + k]) * v[p];
  }
  const std::vector<double> shadow = combined(vectors, along, v.size());
  for (std::size_t p = 0; p < v.size(); ++p) v[p] -= shadow[p];
}

/// U'U = I: each mode alone, and all of them together in the random direction c. Those that c leaves out are no longer
/// than a mode, but may be nothing.
bool orthonormal(std::span<const float> vectors, const std::vector<double>& c, std::size_t order) {
  std::vector<double> lengths(c.size(), 0.0);
  for (std::size_t p = 0; p < order; ++p) {
    for (std::size_t k = 0; k < c.size(); ++k) {
      const auto value = static_cast<double>(vectors[p * c.size() + k]);
      lengths[k] += value * value;
    }
  }
  for (std::size_t k = 0; k < c.size(); ++k) {
    const double off = c[k] == 0.0 ? std::max(lengths[k] - 1.0, 0.0) : std::abs(lengths[k] - 1.0);
    if (!(off <= (c[k] == 0.0 ? most_residual : most_stretch))) return false;
  }
  const double total = squared(c);
  return std::abs(squared(combined(vectors, c, order)) - total) <= most_stretch * total;
}

/// Nothing of A A' that the modes leave out is larger than the bound behind their eigenvalues.
bool bounds_the_rest(std::span<const float> values, std::span<const float> vectors, const Response& seeing,
                     const ParityClasses& classes, std::size_t c) {
  constexpr double close_to_last = 0.9, nothing_left = 1e-8;
  constexpr int products = 20;
  const std::size_t count = values.size() - 1;
  const double bound = values[count], last = count > 0 ? values[count - 1] : 0.0F;
  // As eigenvalues mostly lie, and then hardly too small to bound the next.
  if (count > 0 && bound >= close_to_last * last) return true;
  std::vector<double> v = drawn(static_cast<std::size_t>(classes.order(c)));
  const double whole = squared(v);
  leave_out(vectors, count, v);
  if (squared(v) <= nothing_left * whole) return true;
  double largest = 0.0;
  for (int k = 0; k < products; ++k) {
    const double length = std::sqrt(squared(v));
    if (length == 0.0) break;
    for (double& each : v) each /= length;
    std::vector<double> rows(static_cast<std::size_t>(seeing.rows()), 0.0), again(rows.size()),
        back(static_cast<std::size_t>(seeing.cols())), next(v.size(), 0.0);
    add_to_rows(classes, c, v, rows);
    seeing.adjoint(rows, back);
    seeing.forward(back, again);
    for (int m = 0; m < classes.rows(); ++m) {
      const int at = classes.index(c, m);
      if (at >= 0) next[static_cast<std::size_t>(at)] += classes.share(c, m) * again[static_cast<std::size_t>(m)];
    }
    largest = std::max(largest, inner(v, next));
    leave_out(vectors, count, next);
    v = std::move(next);
  }
  return largest <= (1.0 + most_residual) * bound + 1e-6 * static_cast<double>(values[0]);
}

}  // namespace

bool inverts(const core::ClassInverse<float>& inverse, const Response& seeing, const core::Metric<float>& metric,
             double rho) {
  const auto rows = static_cast<std::size_t>(seeing.rows()), pixels = static_cast<std::size_t>(seeing.cols());
  const std::vector<double> v = drawn(rows);
  std::vector<float> in(v.begin(), v.end()), out(rows), scratch(inverse.scratch_size());
  multiply(inverse, in.data(), out.data(), scratch.data());
  const std::vector<double> solved(out.begin(), out.end());
  std::vector<double> back(pixels), again(rows);
  seeing.adjoint(solved, back);
  if (!metric.is_identity()) {
    core::Metric<float> alone = metric;
    alone.dct.crew = {};
    std::vector<float> picture(back.begin(), back.end()), coefficients(pixels),
        dct(core::dct_scratch_size(metric.dct.rows.length, metric.dct.cols.length));
    core::apply_inverse(alone, picture.data(), coefficients.data(), dct.data());
    back.assign(picture.begin(), picture.end());
  }
  seeing.forward(back, again);
  for (std::size_t m = 0; m < rows; ++m) again[m] += rho * solved[m];
  return near(again, v);
}

bool are_modes(std::span<const float> modes, int rank, const Response& seeing, const ParityClasses& classes) {
  const auto rows = static_cast<std::size_t>(seeing.rows());
  std::vector<double> back(static_cast<std::size_t>(seeing.cols())), again(rows);
  for (std::size_t c = 0; c < classes.count(); ++c) {
    const std::size_t count = modes_of_class(classes, c, rank), order = static_cast<std::size_t>(classes.order(c));
    const auto values = modes.first(count + 1), vectors = modes.subspan(count + 1, count * order);
    modes = modes.subspan(count + 1 + count * order);
    const std::vector<double> wanted = drawn(count);
    std::vector<double> scaled = wanted;
    for (std::size_t k = 0; k < count; ++k) {
      if (!(values[k] >= values[k + 1] && values[k + 1] >= 0.0F)) return false;
      // A mode of nothing but rounding has no product to compare with.
      scaled[k] = values[k] > 1e-6F * values[0] ? wanted[k] / static_cast<double>(values[k]) : 0.0;
    }
    std::vector<double> expected(rows, 0.0), start(rows, 0.0), kept = wanted;
    for (std::size_t k = 0; k < count; ++k) kept[k] = scaled[k] == 0.0 ? 0.0 : wanted[k];
    if (!orthonormal(vectors, kept, order) || !bounds_the_rest(values, vectors, seeing, classes, c)) return false;
    add_to_rows(classes, c, combined(vectors, kept, order), expected);
    add_to_rows(classes, c, combined(vectors, scaled, order), start);
    seeing.adjoint(start, back);
    seeing.forward(back, again);
    if (!near(again, expected)) return false;
  }
  return true;
}

}  // namespace compueye::recon
