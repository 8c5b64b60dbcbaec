#include "sim/render/relief_heights.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace compueye::sim {
namespace {

/// Of the map, at shares of its width and height.
double sampled(const hal::Image& map, double across, double down) {
  const double c = std::clamp(across * map.cols - 0.5, 0.0, map.cols - 1.0);
  const double r = std::clamp(down * map.rows - 0.5, 0.0, map.rows - 1.0);
  const int c0 = std::min(static_cast<int>(c), std::max(0, map.cols - 2));
  const int r0 = std::min(static_cast<int>(r), std::max(0, map.rows - 2));
  const int c1 = std::min(c0 + 1, map.cols - 1), r1 = std::min(r0 + 1, map.rows - 1);
  const auto row_at = [&](int row) {
    const double left = static_cast<double>(map.at(row, c0)), right = static_cast<double>(map.at(row, c1));
    return left + (c - c0) * (right - left);
  };
  return row_at(r0) + (r - r0) * (row_at(r1) - row_at(r0));
}

}  // namespace

ReliefHeights::ReliefHeights(const hal::Image& heights, int rows, int cols, double width_mm, double height_mm)
    : rows_(rows), cols_(cols), width_(width_mm), height_(height_mm) {
  for (int row = 0; row <= rows; ++row) {
    for (int col = 0; col <= cols; ++col) {
      corners_.push_back(sampled(heights, static_cast<double>(col) / cols, static_cast<double>(row) / rows));
    }
  }
  for (int size = 1;; size *= 2) {
    add_level(size);
    if (size >= std::max(rows, cols)) break;
  }
}

void ReliefHeights::add_level(int size) {
  Level level{size, (rows_ + size - 1) / size, (cols_ + size - 1) / size, {}, {}};
  for (int row = 0; row < level.rows; ++row) {
    for (int col = 0; col < level.cols; ++col) {
      Range range{std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()};
      for (int r = row * size; r <= std::min((row + 1) * size, rows_); ++r) {
        for (int c = col * size; c <= std::min((col + 1) * size, cols_); ++c) {
          range.lo = std::min(range.lo, at(r, c));
          range.hi = std::max(range.hi, at(r, c));
        }
      }
      level.ranges.push_back(range);
    }
  }
  const auto block = [&](int row, int col) {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(level.cols) + static_cast<std::size_t>(col);
  };
  for (int row = 0; row < level.rows; ++row) {
    for (int col = 0; col < level.cols; ++col) {
      double highest = std::numeric_limits<double>::lowest();
      for (int r = std::max(0, row - 1); r <= std::min(row + 1, level.rows - 1); ++r) {
        for (int c = std::max(0, col - 1); c <= std::min(col + 1, level.cols - 1); ++c) {
          highest = std::max(highest, level.ranges[block(r, c)].hi);
        }
      }
      level.around.push_back(highest);
    }
  }
  ranges_.push_back(std::move(level));
}

const ReliefHeights::Level& ReliefHeights::level_for(double pixels) const noexcept {
  for (const Level& level : ranges_) {
    if (level.size >= pixels * (1.0 - 1e-9)) return level;
  }
  return ranges_.back();
}

ReliefHeights::Pixel ReliefHeights::pixel_at(double x, double y) const noexcept {
  return {std::clamp(static_cast<int>((0.5 - y / height_) * rows_), 0, rows_ - 1),
          std::clamp(static_cast<int>((x / width_ + 0.5) * cols_), 0, cols_ - 1)};
}

ReliefHeights::Patch ReliefHeights::patch(const Pixel& pixel, double x, double y) const noexcept {
  const double a = (x / width_ + 0.5) * cols_ - pixel.col, b = (0.5 - y / height_) * rows_ - pixel.row;
  const double h00 = at(pixel.row, pixel.col), h01 = at(pixel.row, pixel.col + 1);
  const double h10 = at(pixel.row + 1, pixel.col), h11 = at(pixel.row + 1, pixel.col + 1);
  const double top = h00 + a * (h01 - h00), bottom = h10 + a * (h11 - h10);
  const double across = (1.0 - b) * (h01 - h00) + b * (h11 - h10);
  return {top + b * (bottom - top), across * cols_ / width_, (top - bottom) * rows_ / height_};
}

ReliefHeights::Range ReliefHeights::range(const Cell& cell) const noexcept {
  const double pixels = std::max(cell.width * cols_ / width_, cell.height * rows_ / height_);
  if (pixels < 1.0 - 1e-9) return range_within(cell);
  const Level& level = level_for(pixels);
  const Pixel first = pixel_at(cell.x - 0.499999 * cell.width, cell.y + 0.499999 * cell.height);
  const Pixel last = pixel_at(cell.x + 0.499999 * cell.width, cell.y - 0.499999 * cell.height);
  Range range{std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()};
  for (int r = first.row / level.size; r <= last.row / level.size; ++r) {
    for (int c = first.col / level.size; c <= last.col / level.size; ++c) {
      const Range& block =
          level
              .ranges[static_cast<std::size_t>(r) * static_cast<std::size_t>(level.cols) + static_cast<std::size_t>(c)];
      range.lo = std::min(range.lo, block.lo);
      range.hi = std::max(range.hi, block.hi);
    }
  }
  return range;
}

ReliefHeights::Range ReliefHeights::range_within(const Cell& cell) const noexcept {
  const Pixel pixel = pixel_at(cell.x, cell.y);
  const double x = 0.5 * cell.width, y = 0.5 * cell.height;
  const double a = patch(pixel, cell.x - x, cell.y - y).height, b = patch(pixel, cell.x + x, cell.y - y).height;
  const double c = patch(pixel, cell.x - x, cell.y + y).height, d = patch(pixel, cell.x + x, cell.y + y).height;
  return {std::min({a, b, c, d}), std::max({a, b, c, d})};
}

double ReliefHeights::height_on_line(double col, double row, bool vertical) const noexcept {
  if (vertical) {
    const int c = static_cast<int>(std::lround(col)), r = std::clamp(static_cast<int>(row), 0, rows_ - 1);
    return at(r, c) + (row - r) * (at(r + 1, c) - at(r, c));
  }
  const int r = static_cast<int>(std::lround(row)), c = std::clamp(static_cast<int>(col), 0, cols_ - 1);
  return at(r, c) + (col - c) * (at(r, c + 1) - at(r, c));
}

double ReliefHeights::clearance(const Pixel& pixel, double x, double y, const hal::Vec3& apex) const noexcept {
  const double height = patch(pixel, x, y).height, rise = apex.z - height, top = highest();
  const double col0 = (x / width_ + 0.5) * cols_, row0 = (0.5 - y / height_) * rows_;
  const double dc = (apex.x / width_ + 0.5) * cols_ - col0, dr = (0.5 - apex.y / height_) * rows_ - row0;
  const double last = rise > 0.0 ? std::min(1.0, (top - height) / rise) : 1.0;  // above all of it from there
  double least = rise;
  // The lines of the grid that the way crosses, those across and those down in turn.
  for (const bool vertical : {true, false}) {
    const double step = vertical ? dc : dr, from = vertical ? col0 : row0;
    if (std::fabs(step) < 1e-12) continue;
    const int own = vertical ? pixel.col : pixel.row, lines = vertical ? cols_ : rows_;
    const int way = step > 0.0 ? 1 : -1;
    for (int line = step > 0.0 ? own + 1 : own; line >= 0 && line <= lines; line += way) {
      const double f = (line - from) / step;
      if (f > last) break;
      if (f < 1e-9) continue;
      const double col = vertical ? line : col0 + f * dc, row = vertical ? row0 + f * dr : line;
      if (col < 0.0 || col > cols_ || row < 0.0 || row > rows_) break;
      least = std::min(least, rise - (height_on_line(col, row, vertical) - height) / f);
    }
  }
  return least;
}

bool ReliefHeights::clear(const Cell& cell, const hal::Vec3& apex) const noexcept {
  const double across = cell.width * cols_ / width_, down = cell.height * rows_ / height_;
  const Level& level = level_for(std::max(across, down));
  const double lowest = range(cell).lo, rise = apex.z - lowest, top = highest();
  if (lowest == top) return true;
  if (!(rise > 0.0)) return false;
  const double col0 = (cell.x / width_ + 0.5) * cols_, row0 = (0.5 - cell.y / height_) * rows_;
  const double dc = (apex.x / width_ + 0.5) * cols_ - col0, dr = (0.5 - apex.y / height_) * rows_ - row0;
  const double last = std::min(1.0, (top - lowest) / rise), way = std::max(std::fabs(dc), std::fabs(dr));
  const double step = 0.5 * level.size / std::max(way, 1e-12);
  for (double f = 0.0; f < last; f += step) {
    const double col = col0 + f * dc, row = row0 + f * dr;
    if (col < -0.5 * across || row < -0.5 * down || col > cols_ + 0.5 * across || row > rows_ + 0.5 * down) break;
    const int r = std::clamp(static_cast<int>(row) / level.size, 0, level.rows - 1);
    const int c = std::clamp(static_cast<int>(col) / level.size, 0, level.cols - 1);
    const double around =
        level.around[static_cast<std::size_t>(r) * static_cast<std::size_t>(level.cols) + static_cast<std::size_t>(c)];
    if (lowest + rise * f < around) return false;
  }
  return true;
}

}  // namespace compueye::sim
