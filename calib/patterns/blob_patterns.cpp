#include <algorithm>
#include <numeric>
#include <vector>

#include "calib/patterns/pattern_painters.hpp"
#include "calib/row_draws.hpp"

namespace compueye::calib {
namespace {

constexpr std::int64_t weight_unit = 1 << 12;  // of an interpolation's weights

/// Smooth step 3 t^2 - 2 t^3 at t = k / pitch, in units of 1 / weight_unit.
std::int64_t step_weight(std::int64_t k, std::int64_t pitch) noexcept {
  return k * k * (3 * pitch - 2 * k) * weight_unit / (pitch * pitch * pitch);
}

/// Pixels first .. of an axis between knots `pitch` apart: the knot before each, and the next one's weight.
struct Axis {
  std::vector<std::size_t> knot;
  std::vector<std::int64_t> weight;
  std::size_t knots = 0;

  Axis(int pixels, std::int64_t pitch, std::int64_t offset) {
    for (int i = 0; i < pixels; ++i) {
      const std::int64_t at = i + offset;
      knot.push_back(static_cast<std::size_t>(at / pitch));
      weight.push_back(step_weight(at % pitch, pitch));
    }
    knots = knot.back() + 2;
  }
};

std::int64_t between(std::int64_t one, std::int64_t next, std::int64_t weight) noexcept {
  return one * (weight_unit - weight) + next * weight;
}

void add_octave(const hal::Image& image, std::int64_t pitch, RowDraws& draws, std::vector<std::int64_t>& sums) {
  // Offsets at random make every pixel as likely to lie on a knot as between them. A pitch is a power of two.
  const auto offset = [&] { return static_cast<std::int64_t>(draws.next_bits() >> 32) & (pitch - 1); };
  const std::int64_t down_offset = offset(), across_offset = offset();
  const Axis down(image.rows, pitch, down_offset), across(image.cols, pitch, across_offset);
  std::vector<std::int64_t> values(down.knots * across.knots);
  for (std::int64_t& value : values) value = static_cast<std::int64_t>(draws.next_bits() >> 48) - 32768;
  // Interpolation leaves some .75 of the deviation between knots, and all of it where there is nothing between them.
  const std::int64_t gain = pitch == 1 ? 3 : 4;
  for (std::size_t r = 0, n = 0; r < down.knot.size(); ++r) {
    const std::int64_t* upper = values.data() + down.knot[r] * across.knots;
    const std::int64_t* lower = upper + across.knots;
    for (std::size_t c = 0; c < across.knot.size(); ++c, ++n) {
      const std::size_t k = across.knot[c];
      const std::int64_t above = between(upper[k], upper[k + 1], across.weight[c]);
      const std::int64_t below = between(lower[k], lower[k + 1], across.weight[c]);
      sums[n] += gain * between(above, below, down.weight[r]);
    }
  }
}

}  // namespace

hal::Image blob_pattern(int rows, int cols, std::uint64_t seed, std::int64_t index) {
  hal::Image image(rows, cols);
  RowDraws draws(seed, static_cast<std::uint32_t>(index));
  std::vector<std::int64_t> sums(image.pixels.size(), 0);
  const std::int64_t coarsest = std::min(std::max(rows, cols) / 2, 1 << 12);
  for (std::int64_t pitch = 1; pitch == 1 || pitch <= coarsest; pitch *= 2) add_octave(image, pitch, draws, sums);

  std::vector<std::size_t> order(sums.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  // Of an odd number the one in the middle is lit every other time.
  const std::size_t lit = (order.size() + static_cast<std::size_t>(index % 2)) / 2;
  const auto brighter = [&](std::size_t a, std::size_t b) { return sums[a] != sums[b] ? sums[a] > sums[b] : a < b; };
  std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(lit), order.end(), brighter);
  for (std::size_t n = 0; n < lit; ++n) image.pixels[order[n]] = 1.0F;
  return image;
}

}  // namespace compueye::calib
