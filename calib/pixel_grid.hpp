#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "calib/cone_section.hpp"
#include "calib/pixel_coverage.hpp"
#include "hal/eye_geometry.hpp"

namespace compueye::calib {

/// The pixels of an object plane as one section after another covers them. Not for two threads at once.
class PixelGrid {
 public:
  explicit PixelGrid(const hal::ObjectPlane& plane);

  /// Calls visit(pixel, covered fraction above negligible_coverage) in ascending order of pixels.
  template <class Visitor>
  void for_each_covered(const ConeSection& section, Visitor&& visit) {
    for_each_row(section, [&](int r, double y0, double y1, const RowSpan& span) {
      const std::int32_t first = r * cols_;
      const auto border_pixels = [&](int begin, int end) {
        for (int c = begin; c < end; ++c) {
          const auto left = static_cast<std::size_t>(c);
          const double a = coverage(section, {from_vertex_[left], from_vertex_[left + 1], y0, y1}, span);
          if (a > negligible_coverage) visit(first + c, a);
        }
      };
      border_pixels(span.begin, span.full_begin);
      for (int c = span.full_begin; c < span.full_end; ++c) visit(first + c, 1.0);
      border_pixels(span.full_end, span.end);
    });
  }

  /// How many pixels the section may touch; at least as many as for_each_covered() visits.
  [[nodiscard]] std::int64_t count_touched(const ConeSection& section);

 private:
  // Calls visit(r, y0, y1, span) for every row of pixels that the section touches, top first.
  template <class Visitor>
  void for_each_row(const ConeSection& section, Visitor&& visit) {
    if (section.empty()) return;
    for (std::size_t c = 0; c < x_.size(); ++c) from_vertex_[c] = x_[c] - section.vertex_x_mm();
    for (int r = 0; r < rows_; ++r) {
      const auto bottom = static_cast<std::size_t>(rows_ - 1 - r);
      const double y0 = y_[bottom] - section.vertex_y_mm(), y1 = y_[bottom + 1] - section.vertex_y_mm();
      const RowSpan span = row_span(section, from_vertex_, y0, y1);
      if (span.touched() > 0) visit(r, y0, y1, span);
    }
  }

  std::vector<double> x_, y_;        // borders, mm from the plane's centre
  std::vector<double> from_vertex_;  // borders along x, mm from the section's vertex
  int rows_, cols_;
};

}  // namespace compueye::calib
