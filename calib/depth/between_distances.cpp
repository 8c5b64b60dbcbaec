#include "calib/depth/between_distances.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "calib/depth/sight_line.hpp"
#include "calib/estimate/cone_fit.hpp"
#include "calib/rows_by_threads.hpp"
#include "hal/try.hpp"

namespace compueye::calib {
namespace {

double mix(double near, double far, double share) noexcept {
  return (1.0 - share) * near + share * far;
}

PlaneError mix(const PlaneError& near, const PlaneError& far, double share) noexcept {
  return {mix(near.distance_mm, far.distance_mm, share), mix(near.lean_rad, far.lean_rad, share),
          mix(near.tilt_rad, far.tilt_rad, share)};
}

/// A row's sigma at a place between pixels: that of the entries around it. 0: there are none.
double sigma_at(const RowEstimate& row, const PlacePx& at, const hal::ObjectPlane& plane) noexcept {
  const double top = std::floor(at.row), left = std::floor(at.col);
  double sum = 0.0, weights = 0.0;
  for (const int down : {0, 1}) {
    for (const int across : {0, 1}) {
      const double r = top + down, c = left + across;
      if (r < 0.0 || c < 0.0 || r >= plane.rows || c >= plane.cols) continue;
      const auto pixel = static_cast<std::int32_t>(r * plane.cols + c);
      const auto found = std::lower_bound(row.columns.begin(), row.columns.end(), pixel);
      if (found == row.columns.end() || *found != pixel) continue;
      const double weight = (1.0 - std::fabs(at.row - r)) * (1.0 - std::fabs(at.col - c));
      sum += weight * static_cast<double>(row.sigmas[static_cast<std::size_t>(found - row.columns.begin())]);
      weights += weight;
    }
  }
  return weights > 0.0 ? sum / weights : 0.0;
}

/// Of one thread.
class Interpolation {
 public:
  Interpolation(const hal::EyeGeometry& eye, const hal::ObjectPlane& plane, const AtDistance& near,
                const AtDistance& far)
      : model_(eye, plane),
        sessions_{&near, &far},
        share_((plane.distance_mm - near.distance_mm) / (far.distance_mm - near.distance_mm)),
        gain_share_(std::log(plane.distance_mm / near.distance_mm) / std::log(far.distance_mm / near.distance_mm)),
        plane_(mix(near.rows.plane, far.rows.plane, share_)) {
    const AtDistance& nearer = *sessions_[nearer_one(near.distance_mm, plane.distance_mm, far.distance_mm)];
    for (std::size_t s = 0; s < light_.size(); ++s) light_[s] = nearer.exposure_s / sessions_[s]->exposure_s;
  }

  /// All but the rows.
  [[nodiscard]] ResponseEstimate of_all() const {
    const ResponseEstimate& near = sessions_[0]->rows;
    const ResponseEstimate& far = sessions_[1]->rows;
    ResponseEstimate found;
    found.plane = plane_;
    found.plane_sigma = mix(near.plane_sigma, far.plane_sigma, share_);
    found.gamma = mix(near.gamma, far.gamma, share_);
    found.gamma_sigma = mix(near.gamma_sigma, far.gamma_sigma, share_);
    found.black_level = mix(near.black_level, far.black_level, share_);
    found.black_level_sigma = mix(near.black_level_sigma, far.black_level_sigma, share_);
    found.rows.resize(near.rows.size());
    found.dark_lsb = dark_levels();
    return found;
  }

  [[nodiscard]] RowEstimate row(std::size_t m) {
    return row(static_cast<int>(m), sessions_[0]->rows.rows[m], sessions_[1]->rows.rows[m]);
  }

 private:
  /// One session's row, and where each pixel of the asked plane lies on its display.
  struct Source {
    const RowEstimate* row;
    SightLine line;
  };

  /// Of shares 0 and 1 it is a session's own cone taken to the plane.
  [[nodiscard]] ConeParameters cone(const RowEstimate& near, const RowEstimate& far, double share,
                                    double gain_share) const {
    const ConeParameters drawn = model_.drawn();
    const ConeVector a = departure(near.parameters.cone, drawn), b = departure(far.parameters.cone, drawn);
    ConeVector at = (1.0 - share) * a + share * b;
    at[4] = mix(a[4] + std::log(light_[0]), b[4] + std::log(light_[1]), gain_share);
    return departed(drawn, at);
  }

  [[nodiscard]] static double field(const RowEstimate& row, std::size_t f, const PlacePx& at) noexcept {
    const RowParameters& p = row.parameters;
    if (p.field[f].empty()) return 0.0;
    return field_at(p.field[f], p.grid, splines_at(at.row, p.grid.first_row_px, p.grid.pitch_px, p.grid.rows),
                    splines_at(at.col, p.grid.first_col_px, p.grid.pitch_px, p.grid.cols));
  }

  /// How much the far session counts at a pixel.
  [[nodiscard]] double share_at(const PlacePx& near, const PlacePx& far, double share) const noexcept {
    const hal::ObjectPlane& plane = model_.plane();
    if (!on(plane, far)) return 0.0;
    return on(plane, near) ? share : 1.0;
  }

  /// Entries over `support` with the fields of both by that share.
  [[nodiscard]] std::vector<double> entries(const RowSupport& support, const std::array<Source, 2>& from,
                                            double share) const {
    std::vector<double> found = support.envelope[0];
    for (std::size_t j = 0; j < found.size(); ++j) {
      const std::array<PlacePx, 2> at{from[0].line.through(support.pixels[j]), from[1].line.through(support.pixels[j])};
      const double here = share_at(at[0], at[1], share);
      for (std::size_t f = 0; f < field_kinds; ++f) {
        found[j] += support.envelope[f][j] * mix(field(*from[0].row, f, at[0]), field(*from[1].row, f, at[1]), here);
      }
      found[j] = std::max(found[j], 0.0);
    }
    return found;
  }

  /// Dark codes do not grow with the exposure as light does: of another one they say nothing.
  [[nodiscard]] std::vector<double> dark_levels() const {
    const std::vector<double>& near = sessions_[0]->rows.dark_lsb;
    const std::vector<double>& far = sessions_[1]->rows.dark_lsb;
    if (near.size() != far.size() || light_[0] != light_[1]) return light_[0] == 1.0 ? near : far;
    std::vector<double> between;
    for (std::size_t m = 0; m < near.size(); ++m) between.push_back(mix(near[m], far[m], share_));
    return between;
  }

  /// Of a session alone, by pixel of the display.
  void alone(int m, std::size_t session, const std::array<Source, 2>& from, std::vector<double>& by_pixel) {
    const auto share = static_cast<double>(session);
    const PlaneError& plane = sessions_[session]->rows.plane;
    const RowSupport support = support_of(model_, m / model_.eye().columns, m % model_.eye().columns,
                                          cone(*from[0].row, *from[1].row, share, share), plane);
    const std::vector<double> values = entries(support, from, share);
    by_pixel.assign(static_cast<std::size_t>(model_.plane().pixels()), 0.0);
    for (std::size_t j = 0; j < values.size(); ++j) by_pixel[static_cast<std::size_t>(support.pixels[j])] = values[j];
  }

  RowEstimate row(int m, const RowEstimate& near, const RowEstimate& far) {
    RowEstimate found;
    found.status = near.status == ChannelStatus::good ? far.status : near.status;
    found.held_out_chi2 = std::max(near.held_out_chi2, far.held_out_chi2);
    found.inflation = std::max(near.inflation, far.inflation);
    if (found.status != ChannelStatus::good) return found;
    found.parameters.cone = cone(near, far, share_, gain_share_);
    for (std::size_t p = 0; p < found.parameter_sigma.size(); ++p) {
      found.parameter_sigma[p] = mix(near.parameter_sigma[p], far.parameter_sigma[p], share_);
    }
    const int i = m / model_.eye().columns, k = m % model_.eye().columns;
    const auto line = [&](std::size_t s) {
      return SightLine(model_.eye(), i, k, {model_.plane(), plane_.distance_mm},
                       {at_distance(model_.plane(), sessions_[s]->distance_mm), sessions_[s]->rows.plane.distance_mm});
    };
    const std::array<Source, 2> from{{{&near, line(0)}, {&far, line(1)}}};
    const RowSupport support = support_of(model_, i, k, found.parameters.cone, plane_);
    const std::vector<double> values = entries(support, from, share_);
    alone(m, 0, from, near_alone_);
    alone(m, 1, from, far_alone_);
    for (std::size_t j = 0; j < values.size(); ++j) {
      if (!(values[j] > least_entry)) continue;
      const auto pixel = static_cast<std::size_t>(support.pixels[j]);
      found.columns.push_back(support.pixels[j]);
      found.values.push_back(static_cast<float>(values[j]));
      const double differ = 0.5 * (far_alone_[pixel] - near_alone_[pixel]);
      found.sigmas.push_back(static_cast<float>(std::hypot(sigma(from, support.pixels[j]), differ)));
    }
    return found;
  }

  [[nodiscard]] double sigma(const std::array<Source, 2>& from, std::int32_t pixel) const noexcept {
    const PlacePx near = from[0].line.through(pixel), far = from[1].line.through(pixel);
    const double a = light_[0] * sigma_at(*from[0].row, near, model_.plane());
    const double b = light_[1] * sigma_at(*from[1].row, far, model_.plane());
    if (a == 0.0 || b == 0.0) return std::max(a, b);
    const double share = share_at(near, far, share_);
    return std::hypot((1.0 - share) * a, share * b);
  }

  SoftCone model_;
  std::array<const AtDistance*, 2> sessions_;
  double share_, gain_share_;
  PlaneError plane_;
  std::array<double, 2> light_{};  // what a session's light is multiplied by to be of the nearer one's exposure
  std::vector<double> near_alone_, far_alone_;
};

}  // namespace

std::size_t nearer_one(double near_mm, double asked_mm, double far_mm) noexcept {
  return asked_mm - near_mm <= far_mm - asked_mm ? 0 : 1;
}

hal::Result<ResponseEstimate> between_distances(const hal::EyeGeometry& eye, const hal::ObjectPlane& plane,
                                                const AtDistance& near, const AtDistance& far, int threads,
                                                const recon::Progress& progress) {
  ResponseEstimate found = Interpolation(eye, plane, near, far).of_all();
  TRY(rows_by_threads({found.rows.size(), threads, "rows between distances", progress}, [&]() -> RowWork {
    return [&, between = std::make_shared<Interpolation>(eye, plane, near, far)](std::size_t m) {
      found.rows[m] = between->row(m);
    };
  }));
  return found;
}

}  // namespace compueye::calib
