#include "firmware/eye_page/plots/channel_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "firmware/eye_page/plots/svg_element.hpp"
#include "firmware/eye_page/plots/tone_picture.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using hal::ChannelStatus;
constexpr double map_left = 64.0, map_top = 20.0, side = 400.0;

/// How a channel that is not good is marked: a shape about 0 0, two units wide, so that print in grey tells them apart.
struct Mark {
  ChannelStatus status;
  std::string_view shape;
};
constexpr std::array<Mark, 6> marks{{
    {ChannelStatus::dead, "<circle r=\"0.8\" fill=\"#000\"/>"},
    {ChannelStatus::hot, "<path d=\"M0 -0.9L0.9 0.8H-0.9Z\" fill=\"#d55e00\"/>"},
    {ChannelStatus::noisy, "<path d=\"M0 -1L1 0L0 1L-1 0Z\" fill=\"#9b4f82\"/>"},
    {ChannelStatus::saturated, "<path d=\"M-0.75 -0.75H0.75V0.75H-0.75Z\" fill=\"#e69f00\"/>"},
    {ChannelStatus::does_not_fit,
     "<path d=\"M-0.8 -0.8L0.8 0.8M0.8 -0.8L-0.8 0.8\" fill=\"none\" stroke=\"#d55e00\" stroke-width=\"0.45\"/>"},
    {ChannelStatus::blind, "<circle r=\"0.7\" fill=\"none\" stroke=\"#555\" stroke-width=\"0.25\"/>"},
}};

std::string mark_at(const Mark& mark, double x, double y, double half, std::string_view of) {
  return fmt::format("<g class=\"{}-{}\" transform=\"translate({:.2f} {:.2f}) scale({:.2f})\">{}</g>", of,
                     hal::name(mark.status), x, y, half, mark.shape);
}

class MapDrawing {
 public:
  explicit MapDrawing(const ChannelMap& map)
      : map_(map),
        cell_(side / std::max(map.rows, map.columns)),
        width_(cell_ * map.columns),
        height_(cell_ * map.rows) {}

  [[nodiscard]] double width() const { return width_; }
  [[nodiscard]] double height() const { return height_; }

  [[nodiscard]] hal::Result<std::string> values(const ToneScale& scale) const {
    if (map_.values.empty()) return background();
    return image_element(map_left, map_top, width_, height_,
                         TRY(tone_picture(map_.rows, map_.columns, map_.values, scale)));
  }

  /// Of an eye whose ommatidia can be told apart, with lines between them.
  [[nodiscard]] std::string background() const {
    constexpr double least_cell = 8.0;
    std::string out = fmt::format("<rect class=\"paper\" x=\"{}\" y=\"{}\" width=\"{:.1f}\" height=\"{:.1f}\"/>",
                                  map_left, map_top, width_, height_);
    if (cell_ < least_cell) return out;
    out += "<g class=\"axes\">";
    for (int k = 1; k < map_.columns; ++k)
      out += fmt::format("<path d=\"M{:.1f} {}v{:.1f}\"/>", map_left + k * cell_, map_top, height_);
    for (int i = 1; i < map_.rows; ++i)
      out += fmt::format("<path d=\"M{} {:.1f}h{:.1f}\"/>", map_left, map_top + i * cell_, width_);
    return out + "</g>";
  }

  [[nodiscard]] std::string marked() const {
    std::string out;
    for (std::size_t m = 0; m < map_.status.size(); ++m) {
      const auto mark =
          std::find_if(marks.begin(), marks.end(), [&](const Mark& each) { return each.status == map_.status[m]; });
      if (mark == marks.end()) continue;
      const auto i = static_cast<double>(m / static_cast<std::size_t>(map_.columns));
      const auto k = static_cast<double>(m % static_cast<std::size_t>(map_.columns));
      // Large enough to be seen in an eye of many.
      out +=
          mark_at(*mark, map_left + (k + 0.5) * cell_, map_top + (i + 0.5) * cell_, std::max(0.34 * cell_, 2.5), "is");
    }
    return out;
  }

  [[nodiscard]] std::string axes() const {
    std::string out =
        fmt::format("<rect class=\"frame\" x=\"{}\" y=\"{}\" width=\"{:.1f}\" height=\"{:.1f}\"/><g class=\"axes\">",
                    map_left, map_top, width_, height_);
    const auto stride = [](int count) { return std::max(1, (count + 7) / 8); };
    for (int k = 0; k < map_.columns; k += stride(map_.columns)) {
      out += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>",
                         map_left + (k + 0.5) * cell_, map_top + height_ + 17.0, k);
    }
    for (int i = 0; i < map_.rows; i += stride(map_.rows)) {
      out += fmt::format("<text x=\"{}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>", map_left - 7.0,
                         map_top + (i + 0.5) * cell_ + 4.0, i);
    }
    out += fmt::format(
        "<text class=\"label\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">column of the ommatidium</text>",
        map_left + 0.5 * width_, map_top + height_ + 40.0);
    out += fmt::format(
        "<text class=\"label\" transform=\"translate(16 {:.1f}) rotate(-90)\" text-anchor=\"middle\">row</text>",
        map_top + 0.5 * height_);
    return out + "</g>";
  }

  /// Of the states that there are, with how many.
  [[nodiscard]] std::string legend(double x, double y) const {
    std::string out = "<g class=\"legend\">";
    const auto good = std::count(map_.status.begin(), map_.status.end(), ChannelStatus::good);
    out += fmt::format("<text x=\"{}\" y=\"{}\">{} good: no mark</text>", x, y, good);
    for (const Mark& mark : marks) {
      const auto count = std::count(map_.status.begin(), map_.status.end(), mark.status);
      if (count == 0) continue;
      y += 22.0;
      out += mark_at(mark, x + 6.0, y - 4.0, 6.0, "means");
      out += fmt::format("<text x=\"{}\" y=\"{}\">{} {}</text>", x + 20.0, y, count, hal::name(mark.status));
    }
    return out + "</g>";
  }

 private:
  const ChannelMap& map_;
  double cell_, width_, height_;
};

}  // namespace

hal::Result<std::string> channel_map(const std::string& id, const std::string& about, const ChannelMap& map) {
  const MapDrawing drawing(map);
  const ToneScale scale = ToneScale::by_decades(map.values);
  constexpr double width = 760.0;
  std::string out = svg_opening(id, width, map_top + drawing.height() + 52.0, about);
  out += TRY(drawing.values(scale)) + drawing.axes() + drawing.marked();
  const double beside = map_left + drawing.width() + 28.0;
  const bool toned = !map.values.empty();
  if (toned) out += tone_bar(id, beside, map_top, drawing.height(), scale, map.label);
  out += drawing.legend(beside + (toned ? 96.0 : 0.0), map_top + 14.0);
  return out + "</svg>\n";
}

}  // namespace compueye::firmware
