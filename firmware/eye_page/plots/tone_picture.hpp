#pragma once

#include <string>
#include <vector>

#include "firmware/eye_page/plots/axis.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// Which values the tones stand for, from paper to the darkest.
struct ToneScale {
  double lo = 0.0, hi = 1.0;  ///< lo < hi
  bool logarithmic = false;   ///< lo > 0

  /// From 0 to `top`, or to a little where there is nothing.
  [[nodiscard]] static ToneScale up_to(double top) noexcept;
  /// From the least of the values that are above 0 to the largest, each decade as wide as the other.
  [[nodiscard]] static ToneScale by_decades(const std::vector<double>& values) noexcept;

  /// Of [0, 1]; NaN of NaN.
  [[nodiscard]] double share(double value) const noexcept;
  [[nodiscard]] std::vector<double> ticks() const;
};

/// rows x cols values as a picture in tones: the data URI of a PNG, whose pixels are enlarged, for not all that shows
/// SVG keeps them square. Errors: those of PngEncoder.
[[nodiscard]] hal::Result<std::string> tone_picture(int rows, int cols, const std::vector<double>& values,
                                                    const ToneScale& scale);

/// An SVG <image> of it.
[[nodiscard]] std::string image_element(double x, double y, double width, double height, const std::string& uri);

/// Gradient and ticks of the tones, upright, `height` tall. `id` names its gradient on the page.
[[nodiscard]] std::string tone_bar(const std::string& id, double x, double y, double height, const ToneScale& scale,
                                   const std::string& label);

}  // namespace compueye::firmware
