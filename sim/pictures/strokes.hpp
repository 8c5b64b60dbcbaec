#pragma once

#include <vector>

#include "hal/image.hpp"

namespace compueye::sim::pictures {

struct Point {
  double x = 0.0, y = 0.0;
};

/// A line drawing on the unit square, x right, y down, kept as straight segments.
class Strokes {
 public:
  struct Segment {
    Point a, b;
  };

  void line(Point a, Point b) { segments_.push_back({a, b}); }
  void path(const std::vector<Point>& points, bool closed = false);
  /// Cubic Bezier curve from a to d with control points b and c.
  void curve(Point a, Point b, Point c, Point d);
  /// A chain of cubics: start, then (control, control, end) over and over.
  void curves(const std::vector<Point>& points);
  /// The same chain and its mirror image about x = 1/2.
  void curves_mirrored(std::vector<Point> points);
  void ellipse(Point centre, double rx, double ry);

  [[nodiscard]] std::vector<Segment>& segments() noexcept { return segments_; }
  [[nodiscard]] const std::vector<Segment>& segments() const noexcept { return segments_; }

 private:
  std::vector<Segment> segments_;
};

/// Distance of every pixel's centre to the nearest stroke, in pixels; infinite beyond `reach`. The unit square is the
/// largest square in the middle of the picture.
[[nodiscard]] hal::Image distance_field(const Strokes& strokes, int rows, int cols, double reach);

/// The drawings that line art chooses from; all fill the square evenly and are some 9 to 12 side lengths of ink long.
[[nodiscard]] Strokes draw_butterfly();
[[nodiscard]] Strokes draw_house();
[[nodiscard]] Strokes draw_fish();
[[nodiscard]] Strokes draw_sailing_boat();

}  // namespace compueye::sim::pictures
