#pragma once

#include <string>
#include <vector>

#include "firmware/eye_page/plots/axis.hpp"
#include "firmware/eye_page/plots/spread.hpp"

namespace compueye::firmware {

/// A curve over x with the spread around it.
struct SpreadCurve {
  std::string name;
  std::vector<double> x;      ///< ascending
  std::vector<Spread> y;      ///< one each
  bool shows_points = false;  ///< where it was measured
};

/// An <svg> of curves: median, and the band between a twentieth and nineteen of the values; axes with their units, a
/// legend, told apart by colour, dashes and the shape of points. `id` is unique on its page; `about` is what it shows,
/// for who cannot see it.
[[nodiscard]] std::string curve_plot(const std::string& id, const std::string& about, Axis x, Axis y,
                                     const std::vector<SpreadCurve>& curves);

}  // namespace compueye::firmware
