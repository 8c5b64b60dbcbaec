#pragma once

#include <numbers>
#include <string_view>

#include "calib/nominal.hpp"

namespace compueye::bench {

/// An eye in front of its picture, as the boards of the same name have it.
struct Eye {
  std::string_view name;
  hal::EyeGeometry geometry;
  hal::ObjectPlane plane;
};

inline Eye make_eye(std::string_view name, int side, double interommatidial_deg, double acceptance_deg,
                    const hal::ObjectPlane& plane) {
  constexpr double deg = std::numbers::pi / 180.0;
  Eye eye{name, {}, plane};
  eye.geometry.rows = eye.geometry.columns = side;
  eye.geometry.interommatidial_rad = interommatidial_deg * deg;
  eye.geometry.acceptance_rad = acceptance_deg * deg;
  return eye;
}

inline Eye eye_8x8() {
  return make_eye("8x8", 8, 1.5, 8.0, {16, 16, 8.0, 8.0, 30.0});
}
inline Eye eye_80x80() {
  return make_eye("80x80", 80, 2.25, 60.0, {160, 160, 60.0, 60.0, 10.0});
}

/// Standard deviation of the read noise on the 80x80 board, in fully seen white pixels.
inline constexpr double read_noise = 0.31622776601683794;

}  // namespace compueye::bench
