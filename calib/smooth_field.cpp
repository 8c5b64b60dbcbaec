#include "calib/smooth_field.hpp"

#include <algorithm>
#include <cmath>

namespace compueye::calib {
namespace {

double smooth_step(double t) noexcept {
  return t * t * (3.0 - 2.0 * t);
}

/// Mean of (1-s)^2 + s^2 over a cell, s = smooth_step: what interpolation along one axis leaves of the knots' variance.
constexpr double kept_variance = 26.0 / 35.0;

}  // namespace

SmoothField::SmoothField(const PixelBox& box, double finest_pitch_px, RowDraws& draws) : box_(box) {
  const int rows = box.last_row - box.first_row + 1, cols = box.last_col - box.first_col + 1;
  const double coarsest = std::max(finest_pitch_px, std::max(rows, cols) / 2.0);
  double pitch = finest_pitch_px;
  while (pitch <= coarsest) {
    // Offsets at random make every pixel as likely to lie on a knot as between them.
    const double down = draws.uniform(), across = draws.uniform();
    const auto knots_down = static_cast<std::size_t>((rows - 1) / pitch + down) + 2;
    const auto knots_across = static_cast<std::size_t>((cols - 1) / pitch + across) + 2;
    octaves_.push_back({pitch, down, across, knots_.size(), knots_across});
    for (std::size_t k = 0; k < knots_down * knots_across; ++k) knots_.push_back(draws.normal());
    pitch *= 2.0;
  }
  scale_ = 1.0 / (kept_variance * std::sqrt(static_cast<double>(octaves_.size())));
}

double SmoothField::at(int row, int col) const noexcept {
  double sum = 0.0;
  for (const Octave& octave : octaves_) {
    const double down = (row - box_.first_row) / octave.pitch_px + octave.row_offset;
    const double across = (col - box_.first_col) / octave.pitch_px + octave.col_offset;
    const auto i = static_cast<std::size_t>(down), k = static_cast<std::size_t>(across);
    const double s = smooth_step(across - static_cast<double>(k));
    const double* upper = knots_.data() + octave.first_knot + i * octave.knots_a_row + k;
    const double* lower = upper + octave.knots_a_row;
    const double above = upper[0] + s * (upper[1] - upper[0]), below = lower[0] + s * (lower[1] - lower[0]);
    sum += above + smooth_step(down - static_cast<double>(i)) * (below - above);
  }
  return sum * scale_;
}

}  // namespace compueye::calib
