#include "calib/estimate/entry_gradient.hpp"

#include <algorithm>

namespace compueye::calib {

double EntryGradient::variance(const Eigen::MatrixXd& covariance) const {
  double sum = 0.0;
  for (std::size_t a = 0; a < place.size(); ++a) {
    double row = 0.5 * value[a] * covariance(place[a], place[a]);
    for (std::size_t b = 0; b < a; ++b) row += value[b] * covariance(place[b], place[a]);
    sum += 2.0 * value[a] * row;
  }
  return std::max(sum, 0.0);
}

EntryGradient gradient_of(const RowSupport& support, std::size_t j, const RowParameters& parameters,
                          const FieldSystem::Solution& solution, int plane_cols) {
  EntryGradient gradient;
  const std::int32_t in_cone = support.in_cone[j];
  if (in_cone >= 0) {
    for (std::size_t d = 0; d < ConeRow::changes; ++d) {
      gradient.add(static_cast<int>(d),
                   parameters.cone.gain * support.cone.change[d][static_cast<std::size_t>(in_cone)]);
    }
    gradient.add(4, support.envelope[0][j]);
  }
  const KnotGrid& grid = parameters.grid;
  const SplinesAt down = splines_at(support.pixels[j] / plane_cols, grid.first_row_px, grid.pitch_px, grid.rows);
  const SplinesAt across = splines_at(support.pixels[j] % plane_cols, grid.first_col_px, grid.pitch_px, grid.cols);
  for (std::size_t f = 0; f < field_kinds; ++f) {
    for (int u = 0; u < down.count && !parameters.field[f].empty(); ++u) {
      for (int v = 0; v < across.count; ++v) {
        const auto knot = static_cast<std::size_t>((down.first + u) * grid.cols + across.first + v);
        gradient.add(solution.place[f][knot], support.envelope[f][j] * down.value[static_cast<std::size_t>(u)] *
                                                  across.value[static_cast<std::size_t>(v)]);
      }
    }
  }
  return gradient;
}

}  // namespace compueye::calib
