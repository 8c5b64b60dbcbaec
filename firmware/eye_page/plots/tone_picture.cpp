#include "firmware/eye_page/plots/tone_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "firmware/eye_page/plots/markup.hpp"
#include "firmware/eye_page/plots/tone_ramp.hpp"
#include "firmware/files/png.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {

ToneScale ToneScale::up_to(double top) noexcept {
  return {0.0, top > 0.0 ? top : 1.0, false};
}

ToneScale ToneScale::by_decades(const std::vector<double>& values) noexcept {
  constexpr double apart = 1.25;
  ToneScale scale{std::numeric_limits<double>::infinity(), 0.0, true};
  for (const double value : values) {
    if (!std::isfinite(value) || value <= 0.0) continue;
    scale.lo = std::min(scale.lo, value);
    scale.hi = std::max(scale.hi, value);
  }
  if (scale.hi == 0.0) return {};
  scale.hi = std::max(scale.hi, scale.lo * apart);
  return scale;
}

double ToneScale::share(double value) const noexcept {
  if (!logarithmic) return (value - lo) / (hi - lo);
  return std::isnan(value) ? value : std::log(std::max(value, lo) / lo) / std::log(hi / lo);
}

std::vector<double> ToneScale::ticks() const {
  if (!logarithmic) return Axis{"", lo, hi}.ticks(5);
  std::vector<double> found;
  for (double decade = std::pow(10.0, std::floor(std::log10(lo))); decade <= hi; decade *= 10.0) {
    for (const double step : {1.0, 2.0, 5.0}) {
      if (decade * step >= lo && decade * step <= hi) found.push_back(decade * step);
    }
  }
  return found.size() >= 2 ? found : std::vector<double>{lo, hi};
}

hal::Result<std::string> tone_picture(int rows, int cols, const std::vector<double>& values, const ToneScale& scale) {
  constexpr int least = 320;
  const int factor = std::max(1, (least + std::max(rows, cols) - 1) / std::max(rows, cols));
  auto encoder = TRY(PngEncoder::create(rows * factor, cols * factor, PngFormat::rgb8));
  const auto raster = encoder.raster();
  std::size_t at = 0;
  for (int r = 0; r < rows * factor; ++r) {
    for (int c = 0; c < cols * factor; ++c) {
      const auto n = static_cast<std::size_t>((r / factor) * cols + c / factor);
      for (const std::uint8_t part : tone_of(scale.share(values[n]))) raster[at++] = static_cast<std::byte>(part);
    }
  }
  return png_data_uri(TRY(encoder.encode()));
}

std::string image_element(double x, double y, double width, double height, const std::string& uri) {
  return fmt::format(
      "<image x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" preserveAspectRatio=\"none\" "
      "style=\"image-rendering:pixelated\" xlink:href=\"{}\"/>",
      x, y, width, height, uri);
}

std::string tone_bar(const std::string& id, double x, double y, double height, const ToneScale& scale,
                     const std::string& label) {
  constexpr double bar = 14.0;
  std::string out = fmt::format(
      "<linearGradient id=\"{0}-tones\" x1=\"0\" y1=\"1\" x2=\"0\" y2=\"0\">{1}</linearGradient>"
      "<rect class=\"frame\" x=\"{2}\" y=\"{3}\" width=\"{4}\" height=\"{5}\" style=\"fill:url(#{0}-tones)\"/>"
      "<g class=\"axes\">",
      escaped(id), tone_stops(), x, y, bar, height);
  for (const double tick : scale.ticks()) {
    out += fmt::format("<text x=\"{}\" y=\"{:.1f}\">{}</text>", x + bar + 6.0,
                       y + height * (1.0 - scale.share(tick)) + 4.0, tick_text(tick));
  }
  out +=
      fmt::format("<text class=\"label\" transform=\"translate({} {}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
                  x + bar + 66.0, y + 0.5 * height, escaped(label));
  return out + "</g>";
}

}  // namespace compueye::firmware
