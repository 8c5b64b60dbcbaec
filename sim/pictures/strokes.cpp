#include "sim/pictures/strokes.hpp"

#include <cstddef>

namespace compueye::sim::pictures {

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

}  // namespace compueye::sim::pictures
