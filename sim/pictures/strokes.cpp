#include "sim/pictures/strokes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace compueye::sim::pictures {
namespace {

float distance(double x, double y, Point a, Point b) {
  const double ex = b.x - a.x, ey = b.y - a.y;
  const double length2 = ex * ex + ey * ey;
  const double along = length2 > 0.0 ? std::clamp(((x - a.x) * ex + (y - a.y) * ey) / length2, 0.0, 1.0) : 0.0;
  const double dx = x - a.x - along * ex, dy = y - a.y - along * ey;
  return static_cast<float>(std::sqrt(dx * dx + dy * dy));
}

}  // namespace

void Strokes::path(const std::vector<Point>& points, bool closed) {
  for (std::size_t i = 1; i < points.size(); ++i) line(points[i - 1], points[i]);
  if (closed && points.size() > 2) line(points.back(), points.front());
}

void Strokes::curve(Point a, Point b, Point c, Point d) {
  constexpr int pieces = 24;
  Point from = a;
  for (int i = 1; i <= pieces; ++i) {
    const double t = static_cast<double>(i) / pieces;
    const double s = 1.0 - t;
    const double wa = s * s * s, wb = 3.0 * s * s * t, wc = 3.0 * s * t * t, wd = t * t * t;
    const Point to{wa * a.x + wb * b.x + wc * c.x + wd * d.x, wa * a.y + wb * b.y + wc * c.y + wd * d.y};
    line(from, to);
    from = to;
  }
}

void Strokes::curves(const std::vector<Point>& points) {
  for (std::size_t i = 0; i + 3 < points.size(); i += 3) curve(points[i], points[i + 1], points[i + 2], points[i + 3]);
}

void Strokes::curves_mirrored(std::vector<Point> points) {
  curves(points);
  for (Point& p : points) p.x = 1.0 - p.x;
  curves(points);
}

void Strokes::ellipse(Point centre, double rx, double ry) {
  constexpr double k = 0.5522847498307936;  // 4/3 (sqrt 2 - 1): a quarter circle as a cubic
  const auto at = [&](double x, double y) { return Point{centre.x + rx * x, centre.y + ry * y}; };
  curves({at(1, 0), at(1, k), at(k, 1), at(0, 1), at(-k, 1), at(-1, k), at(-1, 0), at(-1, -k), at(-k, -1), at(0, -1),
          at(k, -1), at(1, -k), at(1, 0)});
}

hal::Image distance_field(const Strokes& strokes, int rows, int cols, double reach) {
  hal::Image field(rows, cols, std::numeric_limits<float>::infinity());
  const double side = std::min(rows, cols);
  const double left = (cols - side) / 2.0, top = (rows - side) / 2.0;
  const auto clip = [](double v, int n) { return std::clamp(static_cast<int>(v), 0, n); };
  for (const Strokes::Segment& segment : strokes.segments()) {
    const Point a{left + side * segment.a.x, top + side * segment.a.y};
    const Point b{left + side * segment.b.x, top + side * segment.b.y};
    const int first_col = clip(std::min(a.x, b.x) - reach, cols), last_col = clip(std::max(a.x, b.x) + reach + 1, cols);
    const int first_row = clip(std::min(a.y, b.y) - reach, rows), last_row = clip(std::max(a.y, b.y) + reach + 1, rows);
    for (int row = first_row; row < last_row; ++row) {
      for (int col = first_col; col < last_col; ++col) {
        field.at(row, col) = std::min(field.at(row, col), distance(col + 0.5, row + 0.5, a, b));
      }
    }
  }
  return field;
}

}  // namespace compueye::sim::pictures
