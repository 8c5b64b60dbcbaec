#include <fmt/format.h>

#include <algorithm>

#include "firmware/eye_page/plots/axis.hpp"
#include "firmware/eye_page/plots/markup.hpp"
#include "firmware/eye_page/plots/svg_element.hpp"
#include "firmware/eye_page/plots/tone_picture.hpp"
#include "firmware/eye_page/sections/sections.hpp"
#include "firmware/text/number_text.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using hal::Result;

/// Ticks of the object plane's pixels along a picture that is `width` x `height` at x, y.
std::string pixel_axes(const hal::ObjectPlane& plane, double x, double y, double width, double height) {
  std::string out =
      fmt::format("<rect class=\"frame\" x=\"{}\" y=\"{}\" width=\"{:.1f}\" height=\"{:.1f}\"/><g class=\"axes\">", x,
                  y, width, height);
  const auto mm = [](double extent) { return Axis{"", -0.5 * extent, 0.5 * extent}; };
  const Axis across = mm(plane.width_mm), down = mm(plane.height_mm);
  for (const double tick : across.ticks()) {
    out += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>",
                       x + across.share(tick) * width, y + height + 17.0, tick_text(tick));
  }
  for (const double tick : down.ticks()) {
    out += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>", x - 7.0,
                       y + (1.0 - down.share(tick)) * height + 4.0, tick_text(tick));
  }
  out += fmt::format(
      "<text class=\"label\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">right of the middle, mm</text>",
      x + 0.5 * width, y + height + 40.0);
  out += fmt::format(
      "<text class=\"label\" transform=\"translate({:.1f} {:.1f}) rotate(-90)\" text-anchor=\"middle\">above it, "
      "mm</text>",
      x - 48.0, y + 0.5 * height);
  return out + "</g>";
}

std::vector<int> seeing_rows(const PageEstimate& newest) {
  std::vector<int> seeing;
  for (const std::int32_t m : newest.rows.response.seeing_rows()) {
    if (newest.estimate.status[static_cast<std::size_t>(m)] == hal::ChannelStatus::good) seeing.push_back(m);
  }
  return seeing;
}

/// Whether the rows are of the file's object plane, as they are but in a file that somebody made otherwise.
bool of_plane(const PageData& data) {
  return data.newest && data.newest->rows.response.cols() == data.eye.plane.pixels();
}

constexpr double page_width = 720.0;

}  // namespace

Result<std::string> light_map(const PageData& data) {
  if (!of_plane(data)) return std::string();
  const hal::ObjectPlane& plane = data.eye.plane;
  std::vector<double> light(static_cast<std::size_t>(plane.pixels()), 0.0);
  const std::vector<int> seeing = seeing_rows(*data.newest);
  for (const int m : seeing) {
    data.newest->rows.response.for_each_in_row(
        m, [&](std::int32_t n, double v) { light[static_cast<std::size_t>(n)] += v; });
  }
  const auto [least, most] = std::minmax_element(light.begin(), light.end());
  const ToneScale tones = ToneScale::up_to(*most);
  const std::string about = fmt::format("the {} good ommatidia together see every pixel {} to {} times over",
                                        seeing.size(), significant(*least, 3), significant(*most, 3));
  constexpr double side = 400.0, left = 80.0, above = 20.0;
  const double scale = side / std::max(plane.rows, plane.cols), width = scale * plane.cols, height = scale * plane.rows;
  std::string out = svg_opening("light-map", page_width, above + height + 52.0, about);
  out += image_element(left, above, width, height, TRY(tone_picture(plane.rows, plane.cols, light, tones)));
  out += pixel_axes(plane, left, above, width, height);
  out += tone_bar("light-map", left + width + 28.0, above, height, tones, "times that a pixel is seen");
  return out + "</svg>\n" + figures_line(about);
}

Result<std::string> receptive_fields(const PageData& data) {
  if (!of_plane(data)) return std::string();
  const std::vector<int> seeing = seeing_rows(*data.newest);
  if (seeing.empty()) return std::string();
  const hal::ObjectPlane& plane = data.eye.plane;
  constexpr std::size_t most = 12, across = 4;
  constexpr double step = 178.0, side = 160.0;
  const std::size_t shown = std::min(most, seeing.size());
  const double scale = side / std::max(plane.rows, plane.cols), width = scale * plane.cols, height = scale * plane.rows;
  const auto lines = static_cast<double>((shown + across - 1) / across);
  std::string out = svg_opening("field-pictures", page_width, lines * (height + 40.0) + 8.0,
                                fmt::format("{} of {} receptive fields on the object plane", shown, seeing.size()));
  for (std::size_t s = 0; s < shown; ++s) {
    const int m = seeing[(2 * s + 1) * seeing.size() / (2 * shown)];
    std::vector<double> row(static_cast<std::size_t>(plane.pixels()), 0.0);
    double top = 0.0;
    data.newest->rows.response.for_each_in_row(m, [&](std::int32_t n, double v) {
      row[static_cast<std::size_t>(n)] = v;
      top = std::max(top, v);
    });
    const double x = 6.0 + step * static_cast<double>(s % across),
                 y = 26.0 + (height + 40.0) * static_cast<double>(s / across);
    out += image_element(x, y, width, height, TRY(tone_picture(plane.rows, plane.cols, row, ToneScale::up_to(top))));
    out += fmt::format(
        "<rect class=\"frame\" x=\"{}\" y=\"{}\" width=\"{:.1f}\" height=\"{:.1f}\"/><g class=\"small\">"
        "<text x=\"{}\" y=\"{}\">row {}, column {} ({})</text></g>\n",
        x, y, width, height, x, y - 7.0, m / data.eye.geometry.columns, m % data.eye.geometry.columns,
        significant(top, 2));
  }
  return out + "</svg>\n";
}

}  // namespace compueye::firmware
