#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <type_traits>
#include <utility>

#include "sim/render/constraint.hpp"
#include "sim/render/covered_part.hpp"
#include "sim/render/picture_sums.hpp"

namespace compueye::sim {

/// Light of a picture on any surface over the part of it where all constraints hold, in pixels of the object plane:
/// tiles of the picture are taken whole where all of a tile counts and its weight is smooth enough for the tile's few
/// masses, else cut into smaller ones, then into pixels, then into quarters of pixels, until what is left undecided at
/// the edges is below the tolerance.
///
/// The bounds are those of single cells; that they are shared out evenly over the cells that an edge meets, and that
/// errors of tiles with detail in them do not all have one sign, is taken for granted and tested.
template <class Map>
class CellIntegral {
 public:
  /// Puts `constraints` into another order.
  CellIntegral(const PictureSums& picture, const Map& map, std::span<Constraint> constraints, double tolerance)
      : picture_(picture), map_(map), constraints_(constraints), tolerance_(tolerance) {}

  [[nodiscard]] double value() {
    const PictureSums::Level& top = picture_.levels().back();
    double sum = 0.0;
    for (int row = 0; row < top.rows; ++row) {
      for (int col = 0; col < top.cols; ++col) sum += tile(picture_.levels().size(), row, col, constraints_.size());
    }
    return sum;
  }

  /// Of one cell of one value alone.
  [[nodiscard]] double piece(const Cell& cell, double value) { return part(cell, value, constraints_.size(), 0); }

 private:
  enum class Decided { nothing, all, some };

  static constexpr std::size_t rim_constraints = 16;  // more than that are left to the picture's own cells

  [[nodiscard]] Cell cell_of(int size, int row, int col) const {
    const int row0 = row * size, col0 = col * size;
    const int down = std::min(size, picture_.rows() - row0), across = std::min(size, picture_.cols() - col0);
    const double w = picture_.pixel_width_mm(), h = picture_.pixel_height_mm();
    return {picture_.left_mm() + (col0 + 0.5 * across) * w, picture_.top_mm() - (row0 + 0.5 * down) * h, across * w,
            down * h};
  }

  /// Moves the constraints that are decided for the cell behind `count`.
  [[nodiscard]] Decided decide(const Cell& cell, const hal::Vec3& d, std::size_t& count) {
    const double there = map_.there(cell);
    if (there == 0.0) return Decided::nothing;
    const double radius = map_.radius(cell);
    for (std::size_t k = 0; k < count;) {
      const double margin = bound_of(constraints_[k], cell, d, radius);
      if (margin <= -radius) return Decided::nothing;
      if (margin >= radius) {
        std::swap(constraints_[k], constraints_[--count]);
      } else {
        ++k;
      }
    }
    return count == 0 && there == 1.0 ? Decided::all : Decided::some;
  }

  [[nodiscard]] double bound_of(const Constraint& constraint, const Cell& cell, const hal::Vec3& d,
                                double radius) const {
    if constexpr (Map::hides_itself) {
      if (constraint.kind == Constraint::Kind::not_by_itself) return radius * map_.shown(cell);
    }
    return constraint.margin(d);
  }

  [[nodiscard]] double tile(std::size_t levels_left, int row, int col, std::size_t count) {
    if (levels_left == 0) {
      const double value = picture_.value(row, col);
      return value == 0.0 ? 0.0 : part(cell_of(1, row, col), value, count, 0);
    }
    const PictureSums::Level& level = picture_.levels()[levels_left - 1];
    const auto index =
        static_cast<std::size_t>(row) * static_cast<std::size_t>(level.cols) + static_cast<std::size_t>(col);
    if (level.total[index] == 0.0) return 0.0;
    const Cell cell = cell_of(level.size, row, col);
    const hal::Vec3 d = map_.at(cell.x, cell.y);
    const Decided decided = decide(cell, d, count);
    if (decided == Decided::nothing) return 0.0;
    if (decided == Decided::all && smooth(cell, d, level.nodes, level.total[index], level.uneven[index])) {
      return whole(level, index, cell);
    }
    if (decided == Decided::some && level.one_value[index]) return part(cell, value_of(level, row, col), count, 0);
    const int finer = levels_left > 1 ? picture_.levels()[levels_left - 2].size : 1;
    const int each = level.size / finer;
    const int last_row = std::min((row + 1) * each, (picture_.rows() + finer - 1) / finer);
    const int last_col = std::min((col + 1) * each, (picture_.cols() + finer - 1) / finer);
    double sum = 0.0;
    for (int r = row * each; r < last_row; ++r) {
      for (int c = col * each; c < last_col; ++c) sum += tile(levels_left - 1, r, c, count);
    }
    return sum;
  }

  [[nodiscard]] double value_of(const PictureSums::Level& level, int row, int col) const {
    return picture_.value(row * level.size, col * level.size);
  }

  [[nodiscard]] double pixel_area() const { return picture_.pixel_width_mm() * picture_.pixel_height_mm(); }

  // The weight is like (1 + t / scale)^-3: its n-th Taylor coefficient is (n+1)(n+2)/2 scale^-n. Interpolation through
  // n Gauss points leaves that times radius^n 2^(1-n), which meets only what is uneven in the tile; an even one is
  // integrated to twice the order.
  [[nodiscard]] bool smooth(const Cell& cell, const hal::Vec3& d, int nodes, double total, double uneven) const {
    if (map_.even()) return true;
    const double ratio = map_.unevenness(cell, d);
    if (!(ratio < 0.5)) return negligible(cell, d, total);
    double power = 1.0;
    for (int k = 0; k < nodes; ++k) power *= 0.5 * ratio;
    const double flux = map_.weight(cell.x, cell.y, d) * pixel_area();
    const double once = (nodes + 1.0) * (nodes + 2.0) * power;
    const double twice = (2.0 * nodes + 1.0) * (2.0 * nodes + 2.0) * power * power;
    return flux * (uneven * once + total * twice) <= 0.4 * tolerance_;
  }

  [[nodiscard]] bool negligible(const Cell& cell, const hal::Vec3& d, double total) const {
    return cell.width * cell.height <= 1e-18 || map_.most_weight(cell, d) * pixel_area() * total <= 2e-3 * tolerance_;
  }

  [[nodiscard]] double whole(const PictureSums::Level& level, std::size_t index, const Cell& cell) const {
    if (map_.even()) return map_.weight(cell.x, cell.y, map_.at(cell.x, cell.y)) * pixel_area() * level.total[index];
    const auto nodes = static_cast<std::size_t>(level.nodes);
    const GaussRule& rule = gauss_rule(level.nodes);
    const double* mass = level.masses.data() + index * nodes * nodes;
    double sum = 0.0;
    for (std::size_t j = 0; j < nodes; ++j) {
      const double y = cell.y + 0.5 * cell.height * rule.at[j];
      for (std::size_t k = 0; k < nodes; ++k) {
        const double x = cell.x + 0.5 * cell.width * rule.at[k];
        sum += mass[j * nodes + k] * map_.weight(x, y, map_.at(x, y));
      }
    }
    return sum * pixel_area();
  }

  /// Mean weight over a cell by nodes x nodes Gauss points.
  [[nodiscard]] double mean_weight(const Cell& cell, int nodes = 2) const {
    const GaussRule& rule = gauss_rule(nodes);
    double sum = 0.0;
    for (std::size_t j = 0; j < static_cast<std::size_t>(nodes); ++j) {
      const double y = cell.y + 0.5 * cell.height * rule.at[j];
      for (std::size_t k = 0; k < static_cast<std::size_t>(nodes); ++k) {
        const double x = cell.x + 0.5 * cell.width * rule.at[k];
        sum += rule.weight[j] * rule.weight[k] * map_.weight(x, y, map_.at(x, y));
      }
    }
    return 0.25 * sum;
  }

  /// A cell of one value: tiles of a picture that are even, pixels, and parts of both.
  [[nodiscard]] double part(const Cell& cell, double value, std::size_t count, int depth) {
    const hal::Vec3 d = map_.at(cell.x, cell.y);
    const Decided decided = decide(cell, d, count);
    if (decided == Decided::nothing) return 0.0;
    const double area = cell.width * cell.height;
    if constexpr (Map::has_rim) {
      if (map_.at_rim(cell) && count + 4 <= rim_constraints) return rim(cell, value, count);
    }
    if (decided == Decided::all) {
      if (const int nodes = nodes_for(cell, d, value); nodes > 0) return value * area * weight_by(nodes, cell, d);
    }
    if (decided == Decided::some) {
      double light = 0.0;
      if (edge(cell, d, value, count, depth, light)) return light;
    }
    if (depth >= 40) return 0.0;
    double sum = 0.0;
    for (const double sx : {-0.25, 0.25}) {
      for (const double sy : {-0.25, 0.25}) {
        const Cell quarter{cell.x + sx * cell.width, cell.y + sy * cell.height, 0.5 * cell.width, 0.5 * cell.height};
        sum += part(quarter, value, count, depth + 1);
      }
    }
    return sum;
  }

  /// The same in the rim's own map, the cell's sides being four more constraints.
  [[nodiscard]] double rim(const Cell& cell, double value, std::size_t count) const {
    const auto map = map_.rim_map(cell);
    std::array<Constraint, rim_constraints> all;
    std::copy_n(constraints_.begin(), count, all.begin());
    for (const HalfSpace& side : map.sides(cell)) all[count++] = Constraint(side);
    return CellIntegral<std::remove_const_t<decltype(map)>>(picture_, map, {all.data(), count}, tolerance_)
        .piece(map.about(cell), value);
  }

  /// Gauss points each way that give the cell's mean weight; 0: too many.
  [[nodiscard]] int nodes_for(const Cell& cell, const hal::Vec3& d, double value) const {
    if (map_.even()) return 1;
    const double ratio = map_.unevenness(cell, d);
    const double light = value * cell.width * cell.height * map_.most_weight(cell, d);
    if (!(ratio < 0.5)) return light <= 2e-3 * tolerance_ || cell.width * cell.height <= 1e-18 ? 2 : 0;
    double power = light * ratio * ratio;
    for (int nodes = 2; nodes <= 5; ++nodes) {
      power *= ratio * ratio;
      if (power <= 3e-5 * tolerance_) return nodes;
    }
    return 0;
  }
  [[nodiscard]] double weight_by(int nodes, const Cell& cell, const hal::Vec3& d) const {
    return nodes == 1 ? map_.weight(cell.x, cell.y, d) : mean_weight(cell, nodes);
  }

  /// A cell that an edge meets, when it is simple enough or small enough to be cut at once.
  [[nodiscard]] bool edge(const Cell& cell, const hal::Vec3& d, double value, std::size_t count, int depth,
                          double& light) {
    const double area = cell.width * cell.height;
    const double middle_weight = map_.weight(cell.x, cell.y, d);
    const double most = value * area * map_.most_weight(cell, d);
    const bool small = most <= 2e-3 * tolerance_ || depth >= 40;
    if (map_.there(cell) != 1.0) {
      if (!small) return false;
      find_open(d, map_.radius(cell), count);
      light = margin_at(cell, cell.x, cell.y, count) > 0.0 ? value * area * middle_weight : 0.0;
      return true;
    }
    find_open(d, map_.radius(cell), count);
    const double hw = 0.5 * cell.width, hh = 0.5 * cell.height;
    const CornerMargins margins{
        {margin_at(cell, cell.x - hw, cell.y - hh, count), margin_at(cell, cell.x + hw, cell.y - hh, count),
         margin_at(cell, cell.x + hw, cell.y + hh, count), margin_at(cell, cell.x - hw, cell.y + hh, count)},
        margin_at(cell, cell.x, cell.y, count)};
    const bool single = count == 1 && Constraint::one_edge(open_[0]);
    const double bend = margins.bend();
    if (!small) {
      if (!single && !(bend < 1e-9)) return false;
      if (!(most * bend * bend <= 8e-3 * tolerance_)) return false;
      const double ratio = map_.even() ? 0.0 : map_.unevenness(cell, d);
      if (!(most * ratio * ratio * ratio <= 2e-3 * tolerance_)) return false;
    }
    const int inside = margins.inside();
    if (inside == 0 || inside == 4) {
      // A cap of the edge may still stand in the cell, about as deep as the margin is bent.
      if (!small && nearest(margins) < 2.0 * bend && most * bend * std::sqrt(bend) > 2e-3 * tolerance_) return false;
      light = 0.0;
      if (inside == 0) return true;
      const int nodes = small ? 2 : nodes_for(cell, d, value);
      light = value * area * weight_by(map_.even() ? 1 : nodes, cell, d);
      return nodes > 0;
    }
    const bool straight = small || (Map::flat && count == 1 && constraints_[0].linear());
    const CoveredPart covered =
        covered_part(cell, margins, straight, [&](double x, double y) { return margin_at(cell, x, y, count); });
    if (!covered.known && !small) return false;
    light = covered.known ? value * weighed(cell, covered, middle_weight) : 0.5 * value * area * middle_weight;
    return true;
  }

  /// Least distance of a corner's margin from zero, as a share of their range.
  [[nodiscard]] static double nearest(const CornerMargins& margins) {
    double least = std::fabs(margins.corner[0]), lo = margins.corner[0], hi = lo;
    for (const double g : margins.corner) {
      least = std::min(least, std::fabs(g));
      lo = std::min(lo, g);
      hi = std::max(hi, g);
    }
    return least / (hi - lo);
  }

  [[nodiscard]] double weighed(const Cell& cell, const CoveredPart& covered, double middle_weight) const {
    if (map_.even()) return covered.area * middle_weight;
    const double bent = (mean_weight(cell) - middle_weight) * covered.area / (cell.width * cell.height);
    return covered.area * (map_.weight(covered.x, covered.y, map_.at(covered.x, covered.y)) + bent);
  }

  /// Which of the constraints' conditions make an edge in the cell, for `margin_at`.
  void find_open(const hal::Vec3& d, double radius, std::size_t count) {
    for (std::size_t k = 0; k < std::min(count, open_.size()); ++k) open_[k] = constraints_[k].open(d, radius);
  }

  [[nodiscard]] double margin_at(const Cell& cell, double x, double y, std::size_t count) const {
    const hal::Vec3 d = map_.at(x, y);
    double least = std::numeric_limits<double>::max();
    for (std::size_t k = 0; k < count; ++k) {
      if constexpr (Map::hides_itself) {
        if (constraints_[k].kind == Constraint::Kind::not_by_itself) {
          least = std::min(least, map_.clearance(cell, x, y));
          continue;
        }
      }
      least = std::min(least, k < open_.size() ? constraints_[k].margin(d, open_[k]) : constraints_[k].margin(d));
    }
    return least;
  }

  const PictureSums& picture_;
  const Map& map_;
  std::span<Constraint> constraints_;
  double tolerance_;
  std::array<unsigned, 16> open_{};
};

}  // namespace compueye::sim
