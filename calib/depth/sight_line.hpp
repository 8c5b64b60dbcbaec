#pragma once

#include <cstdint>

#include "hal/eye_geometry.hpp"

namespace compueye::calib {

/// On a display, in pixels: 0 is the middle of the upper left one.
struct PlacePx {
  double row = 0.0, col = 0.0;
};

/// Whether it lies within the display's edges.
[[nodiscard]] bool on(const hal::ObjectPlane& plane, const PlacePx& at) noexcept;

[[nodiscard]] hal::ObjectPlane at_distance(hal::ObjectPlane plane, double distance_mm) noexcept;

/// Lines from the apex of one ommatidium through a pixel of one display, and where they meet another of as many
/// pixels. Displays are taken for parallel: what they are turned by is milliradians.
class SightLine {
 public:
  struct Display {
    hal::ObjectPlane plane;
    double farther_mm = 0.0;  ///< than its distance
  };
  SightLine(const hal::EyeGeometry& eye, int i, int k, const Display& from, const Display& to) noexcept;

  [[nodiscard]] PlacePx through(std::int32_t pixel) const noexcept;

 private:
  int cols_;
  double apex_row_px_, apex_col_px_;  // where the apex stands over the display
  double ratio_;                      // of the heights over the two
};

}  // namespace compueye::calib
