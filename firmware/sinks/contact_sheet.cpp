#include "firmware/sinks/contact_sheet.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "firmware/files/file_descriptor.hpp"
#include "firmware/sinks/bitmap_font.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::Result;

constexpr Rgb background{18, 21, 26};
constexpr Rgb frame_colour{70, 76, 86};
constexpr Rgb name_colour{240, 242, 245};
constexpr Rgb figure_colour{168, 176, 188};
constexpr int margin = 20;
constexpr int gap = 16;
constexpr int line_height = 24;
constexpr int bar_height = 10;
constexpr int most_panel_pixels = 4096;

constexpr Rgb magenta{255, 0, 255};

struct Stop {
  double at;
  double r, g, b;
};
// Chosen for about the same CIE lightness (20, 50, 65, 92) at each pair of stops.
constexpr std::array<Stop, 5> below_zero{
    {{0.0, 0, 0, 0}, {0.25, 8, 46, 104}, {0.5, 32, 104, 190}, {0.75, 84, 166, 240}, {1.0, 208, 236, 255}}};
constexpr std::array<Stop, 5> above_zero{
    {{0.0, 0, 0, 0}, {0.25, 92, 32, 8}, {0.5, 186, 78, 20}, {0.75, 242, 140, 48}, {1.0, 255, 232, 190}}};

std::uint8_t to_code(double v) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(v, 0.0, 255.0)));
}

class Canvas {
 public:
  Canvas(int rows, int cols) {
    image_.rows = rows;
    image_.cols = cols;
    image_.pixels.resize(static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols) * 3);
    fill(0, 0, rows, cols, background);
  }
  void fill(int top, int left, int rows, int cols, Rgb colour) {
    for (int r = std::max(top, 0); r < std::min(top + rows, image_.rows); ++r) {
      for (int c = std::max(left, 0); c < std::min(left + cols, image_.cols); ++c) {
        const auto at =
            (static_cast<std::size_t>(r) * static_cast<std::size_t>(image_.cols) + static_cast<std::size_t>(c)) * 3;
        std::copy(colour.begin(), colour.end(), image_.pixels.begin() + static_cast<std::ptrdiff_t>(at));
      }
    }
  }
  void text(int top, int left, const std::string& words, Rgb colour) {
    for (const char character : words) {
      const Glyph& glyph = glyph_for(character);
      for (int r = 0; r < glyph_rows; ++r) {
        for (int c = 0; c < glyph_cols; ++c) {
          const unsigned bit = 1U << static_cast<unsigned>(glyph_cols - 1 - c);
          if ((glyph[static_cast<std::size_t>(r)] & bit) != 0) fill(top + r, left + c, 1, 1, colour);
        }
      }
      left += glyph_cols;
    }
  }
  [[nodiscard]] RgbImage take() { return std::move(image_); }

 private:
  RgbImage image_;
};

int text_width(const std::string& words) {
  return static_cast<int>(words.size()) * glyph_cols;
}

// At blanks, and inside a word only when it is longer than a line.
std::vector<std::string> wrap(const std::string& words, int width) {
  const auto most = static_cast<std::size_t>(std::max(width / glyph_cols, 1));
  std::vector<std::string> lines;
  std::string rest = words;
  while (rest.size() > most) {
    std::size_t cut = rest.rfind(' ', most);
    if (cut == std::string::npos || cut == 0) cut = most;
    lines.push_back(rest.substr(0, cut));
    rest.erase(0, std::min(rest.find_first_not_of(' ', cut), rest.size()));
  }
  lines.push_back(rest);
  return lines;
}

// A panel, measured: where its parts go relative to its own top left corner.
struct Layout {
  const Panel* panel;
  int zoom;
  int picture_rows, picture_cols;
  int width;
  double scale;
  std::vector<std::string> figures;
  [[nodiscard]] bool has_bar() const { return panel->kind == PanelKind::signed_error; }
  [[nodiscard]] int caption_height() const {
    return 10 + line_height * (1 + static_cast<int>(figures.size())) + (has_bar() ? bar_height + 4 + line_height : 0);
  }
};

Result<Layout> measure(const Panel& panel, int min_panel_pixels) {
  const hal::Image& image = panel.image;
  const int longer = std::max(image.rows, image.cols);
  const bool whole = image.rows >= 1 && image.cols >= 1 && longer <= most_panel_pixels &&
                     image.pixels.size() == static_cast<std::size_t>(image.rows) * static_cast<std::size_t>(image.cols);
  if (!whole) {
    return hal::fail(ErrorCode::usage, "contact sheet",
                     "was given a panel '" + panel.name + "' of " + std::to_string(image.rows) + " x " +
                         std::to_string(image.cols) + " with " + std::to_string(image.pixels.size()) +
                         " pixels, expected a picture of at most " + std::to_string(most_panel_pixels) + " a side");
  }
  Layout layout{&panel, std::max((min_panel_pixels + longer - 1) / longer, 1), 0, 0, 0, panel.scale, {}};
  layout.picture_rows = image.rows * layout.zoom;
  layout.picture_cols = image.cols * layout.zoom;
  layout.width = std::max(layout.picture_cols, min_panel_pixels);
  for (const std::string& line : panel.figures) {
    for (std::string& part : wrap(line, layout.width)) layout.figures.push_back(std::move(part));
  }
  if (!(layout.scale > 0.0)) layout.scale = error_scale(image);
  return layout;
}

/// Panels side by side.
struct SheetRow {
  std::vector<Layout> layouts;
  int picture_height = 0;
  int caption_height = 0;
  std::int64_t width = 2 * margin - gap;
  [[nodiscard]] int height() const { return picture_height + caption_height; }
};

Result<SheetRow> measure_row(std::span<const Panel> panels, int min_panel_pixels) {
  SheetRow row;
  for (const Panel& panel : panels) {
    Layout layout = TRY(measure(panel, min_panel_pixels));
    row.picture_height = std::max(row.picture_height, layout.picture_rows);
    row.caption_height = std::max(row.caption_height, layout.caption_height());
    row.width += layout.width + gap;
    row.layouts.push_back(std::move(layout));
  }
  return row;
}

std::string short_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%+.3g", value);
  return text;
}

void draw_bar(Canvas& canvas, const Layout& layout, int top, int left) {
  const int width = layout.picture_cols;
  for (int c = 0; c < width; ++c) {
    const double value = width > 1 ? 2.0 * c / (width - 1) - 1.0 : 0.0;
    canvas.fill(top, left + c, bar_height, 1, diverging_colour(value));
  }
  const int below = top + bar_height;
  const std::string low = short_number(-layout.scale), high = short_number(layout.scale);
  canvas.text(below, left, low, figure_colour);
  canvas.text(below, left + (width - glyph_cols) / 2, "0", figure_colour);
  canvas.text(below, left + width - text_width(high), high, figure_colour);
}

void draw_panel(Canvas& canvas, const Layout& layout, int top, int left, int picture_height) {
  const hal::Image& image = layout.panel->image;
  const int x = left + (layout.width - layout.picture_cols) / 2;
  const int y = top + (picture_height - layout.picture_rows) / 2;
  canvas.fill(y - 1, x - 1, layout.picture_rows + 2, layout.picture_cols + 2, frame_colour);
  for (int r = 0; r < image.rows; ++r) {
    for (int c = 0; c < image.cols; ++c) {
      const double value = image.at(r, c);
      const Rgb colour = layout.has_bar() ? diverging_colour(value / layout.scale) : grey_colour(value);
      canvas.fill(y + r * layout.zoom, x + c * layout.zoom, layout.zoom, layout.zoom, colour);
    }
  }
  int line = top + picture_height + 10;
  canvas.text(line, left, wrap(layout.panel->name, layout.width).front(), name_colour);
  if (layout.has_bar()) {
    draw_bar(canvas, layout, line + line_height + 4, x);
    line += bar_height + 4 + line_height;
  }
  for (const std::string& figures : layout.figures) canvas.text(line += line_height, left, figures, figure_colour);
}

}  // namespace

Rgb diverging_colour(double value) noexcept {
  if (std::isnan(value)) return magenta;
  const auto& stops = value < 0.0 ? below_zero : above_zero;
  const double t = std::min(std::abs(value), 1.0);
  std::size_t i = 1;
  while (i + 1 < stops.size() && stops[i].at < t) ++i;
  const Stop &a = stops[i - 1], &b = stops[i];
  const double f = (t - a.at) / (b.at - a.at);
  return {to_code(a.r + f * (b.r - a.r)), to_code(a.g + f * (b.g - a.g)), to_code(a.b + f * (b.b - a.b))};
}

Rgb grey_colour(double value) noexcept {
  if (std::isnan(value)) return magenta;
  const std::uint8_t code = to_code(255.0 * std::clamp(value, 0.0, 1.0));
  return {code, code, code};
}

double error_scale(const hal::Image& error) {
  std::vector<double> magnitudes;
  for (const float v : error.pixels) {
    if (std::isfinite(v)) magnitudes.push_back(std::abs(static_cast<double>(v)));
  }
  if (magnitudes.empty()) return 1.0;
  const auto at = static_cast<std::ptrdiff_t>((magnitudes.size() - 1) * 99 / 100);
  std::nth_element(magnitudes.begin(), magnitudes.begin() + at, magnitudes.end());
  double most = magnitudes[static_cast<std::size_t>(at)];
  if (most == 0.0) most = *std::max_element(magnitudes.begin(), magnitudes.end());
  if (most == 0.0) return 1.0;
  const double decade = std::pow(10.0, std::floor(std::log10(most)));
  // With room for what float32 makes of 0.1.
  for (const double step : {1.0, 2.0, 5.0}) {
    if (most <= step * decade * (1.0 + 1e-6)) return step * decade;
  }
  return 10.0 * decade;
}

Result<Panel> error_panel(const hal::Image& picture, const hal::Image& truth) {
  if (picture.rows != truth.rows || picture.cols != truth.cols || picture.pixels.size() != truth.pixels.size()) {
    return hal::fail(ErrorCode::mismatch, "contact sheet",
                     "was given a picture of " + std::to_string(picture.rows) + " x " + std::to_string(picture.cols) +
                         " and a truth of " + std::to_string(truth.rows) + " x " + std::to_string(truth.cols) +
                         ", expected equal sizes");
  }
  Panel panel;
  panel.name = "error";
  panel.figures = {"picture minus truth"};
  panel.kind = PanelKind::signed_error;
  panel.image = picture;
  for (std::size_t i = 0; i < truth.pixels.size(); ++i) panel.image.pixels[i] -= truth.pixels[i];
  return panel;
}

Result<RgbImage> compose_contact_sheet(const std::string& title, std::span<const Panel> panels, int min_panel_pixels) {
  if (panels.empty()) return hal::fail(ErrorCode::usage, "contact sheet", "was given no panels, expected at least one");
  const int least = std::clamp(min_panel_pixels, 1, most_panel_pixels);
  std::vector<SheetRow> rows;
  std::int64_t width = 0;
  const int title_height = title.empty() ? 0 : line_height + 10;
  std::int64_t height = margin + title_height + margin / 2 - gap;
  for (std::size_t first = 0, end = 0; first < panels.size(); first = end) {
    for (end = first + 1; end < panels.size() && !panels[end].begins_row;) ++end;
    SheetRow row = TRY(measure_row(panels.subspan(first, end - first), least));
    width = std::max(width, row.width);
    height += row.height() + gap;
    rows.push_back(std::move(row));
  }
  if (width > max_png_side || height > max_png_side) {
    return hal::fail(ErrorCode::usage, "contact sheet",
                     "would have " + std::to_string(width) + " x " + std::to_string(height) +
                         " pixels, expected at most " + std::to_string(max_png_side) + " a side: use fewer panels");
  }
  Canvas canvas(static_cast<int>(height), static_cast<int>(width));
  if (!title.empty()) canvas.text(margin - 4, margin, title, name_colour);
  int top = margin + title_height;
  for (const SheetRow& row : rows) {
    int left = margin;
    for (const Layout& layout : row.layouts) {
      draw_panel(canvas, layout, top, left, row.picture_height);
      left += layout.width + gap;
    }
    top += row.height() + gap;
  }
  return canvas.take();
}

Result<void> write_contact_sheet(const std::string& path, const std::string& title, std::span<const Panel> panels,
                                 int min_panel_pixels) {
  return write_png(path, TRY(placed(compose_contact_sheet(title, panels, min_panel_pixels), path)));
}

}  // namespace compueye::firmware
