#include "calib/pixel_coverage.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace compueye::calib {
namespace {

// Rounding may put a border pixel just outside the range it is looked for in; one pixel too many costs nothing.
constexpr double slack_pixels = 1e-9;

// The x in a cell at which its clipped chord changes form, ascending, ends included.
struct Kinks {
  std::array<double, 6> at{};
  std::size_t count = 0;

  void insert(double x) noexcept {
    std::size_t i = count++;
    for (; i > 0 && at[i - 1] > x; --i) at[i] = at[i - 1];
    at[i] = x;
  }
};

Kinks kinks(double lo, double hi, const Interval& at_y0, const Interval& at_y1) {
  Kinks k;
  k.insert(lo);
  for (const Interval* line : {&at_y0, &at_y1}) {
    if (line->empty()) continue;
    for (const double x : {line->lo, line->hi}) {
      if (x > lo && x < hi) k.insert(x);
    }
  }
  k.insert(hi);
  return k;
}

// Between two kinks the region is bounded above by the cell or one arc, and below likewise.
double piece_area(const ConeSection& section, const Cell& cell, double a, double b) {
  const Interval middle = section.chord_at_x(0.5 * (a + b));
  if (middle.empty() || middle.hi <= cell.y0 || middle.lo >= cell.y1) return 0.0;
  const bool upper_arc = middle.hi<cell.y1, lower_arc = middle.lo> cell.y0;
  if (!upper_arc && !lower_arc) return (b - a) * (cell.y1 - cell.y0);

  const auto inside = [&](double y) { return std::clamp(y, cell.y0, cell.y1); };
  const Interval at_a = section.chord_at_x(a), at_b = section.chord_at_x(b);
  const double top_a = upper_arc ? inside(at_a.hi) : cell.y1, top_b = upper_arc ? inside(at_b.hi) : cell.y1;
  const double low_a = lower_arc ? inside(at_a.lo) : cell.y0, low_b = lower_arc ? inside(at_b.lo) : cell.y0;
  double area = 0.5 * (b - a) * ((top_a - low_a) + (top_b - low_b));
  if (upper_arc) area += section.area_beyond_chord(a, top_a, b, top_b, true);
  if (lower_arc) area += section.area_beyond_chord(a, low_a, b, low_b, false);
  return area;
}

// The x between which the section passes through the band y0..y1.
Interval x_range(const ConeSection& section, double y0, double y1, const Interval& at_y0, const Interval& at_y1) {
  Interval range;
  const auto include = [&range](double lo, double hi) {
    range = range.empty() ? Interval{lo, hi} : Interval{std::min(range.lo, lo), std::max(range.hi, hi)};
  };
  for (const Interval* line : {&at_y0, &at_y1}) {
    if (!line->empty()) include(line->lo, line->hi);
  }
  // The leftmost, rightmost, lowest and highest points count where the band holds them.
  const Interval ys = section.y_extent(), xs = section.x_extent();
  for (const double y : {ys.lo, ys.hi}) {
    if (!(y > y0 && y < y1)) continue;
    const Interval tip = section.chord_at_y(y);
    if (!tip.empty()) include(tip.lo, tip.hi);
  }
  for (const double x : {xs.lo, xs.hi}) {
    if (!std::isfinite(x)) continue;
    const Interval tip = section.chord_at_x(x);
    const double y = 0.5 * (tip.lo + tip.hi);
    if (y > y0 && y < y1) include(x, x);
  }
  return range;
}

}  // namespace

double coverage(const ConeSection& section, const Cell& cell, const RowSpan& row) noexcept {
  const Interval xs = section.x_extent();
  const double lo = std::max(cell.x0, xs.lo), hi = std::min(cell.x1, xs.hi);
  if (section.empty() || !(lo < hi)) return 0.0;
  const Kinks k = kinks(lo, hi, row.at_y0, row.at_y1);
  double area = 0.0;
  for (std::size_t i = 0; i + 1 < k.count; ++i) {
    if (k.at[i + 1] > k.at[i]) area += piece_area(section, cell, k.at[i], k.at[i + 1]);
  }
  const double fraction = area / ((cell.x1 - cell.x0) * (cell.y1 - cell.y0));
  return fraction > 1.0 - negligible_coverage ? 1.0 : std::max(fraction, 0.0);
}

double coverage(const ConeSection& section, const Cell& cell) noexcept {
  RowSpan row;
  row.at_y0 = section.chord_at_y(cell.y0);
  row.at_y1 = section.chord_at_y(cell.y1);
  return coverage(section, cell, row);
}

RowSpan row_span(const ConeSection& section, std::span<const double> x_edges, double y0, double y1) noexcept {
  RowSpan row;
  const Interval ys = section.y_extent();
  if (section.empty() || x_edges.size() < 2 || !(ys.lo < y1 && ys.hi > y0)) return row;
  row.at_y0 = section.chord_at_y(y0);
  row.at_y1 = section.chord_at_y(y1);
  const Interval range = x_range(section, y0, y1, row.at_y0, row.at_y1);
  const double left = x_edges.front(), right = x_edges.back();
  if (range.empty() || range.hi <= left || range.lo >= right) return row;

  const int pixels = static_cast<int>(x_edges.size()) - 1;
  const double width = (right - left) / pixels;
  const auto pixel_of = [&](double x) { return (std::clamp(x, left, right) - left) / width; };
  row.begin = std::max(0, static_cast<int>(std::floor(pixel_of(range.lo) - slack_pixels)));
  row.end = std::min(pixels, static_cast<int>(std::ceil(pixel_of(range.hi) + slack_pixels)));
  row.full_begin = row.full_end = row.begin;
  if (row.at_y0.empty() || row.at_y1.empty()) return row;

  // Convex: a pixel lies wholly inside exactly when its four corners do.
  const double lo = std::max(row.at_y0.lo, row.at_y1.lo), hi = std::min(row.at_y0.hi, row.at_y1.hi);
  if (!(hi > lo) || hi <= left || lo >= right) return row;
  const auto edge = [&](int c) { return x_edges[static_cast<std::size_t>(c)]; };
  int first = std::max(row.begin, static_cast<int>(std::floor(pixel_of(lo))));
  while (first < row.end && edge(first) < lo) ++first;
  int last = std::min(row.end, static_cast<int>(std::ceil(pixel_of(hi))));
  while (last > first && edge(last) > hi) --last;
  row.full_begin = first;
  row.full_end = last;
  return row;
}

}  // namespace compueye::calib
