#include "firmware/eye_page/plots/curve_plot.hpp"

#include <fmt/format.h>

#include <array>
#include <string_view>

#include "firmware/eye_page/plots/markup.hpp"
#include "firmware/eye_page/plots/svg_element.hpp"

namespace compueye::firmware {
namespace {

constexpr double width = 720.0, height = 340.0;
constexpr double left = 80.0, right = 700.0, top = 36.0, bottom = 284.0;

struct Look {
  std::string_view colour, dash;
};
// Okabe and Ito's, dark enough for paper.
constexpr std::array<Look, 5> looks{
    {{"#0072b2", "none"}, {"#d55e00", "7 3"}, {"#007a5a", "2 3"}, {"#9b4f82", "9 3 2 3"}, {"#000000", "12 4"}}};

class CurveDrawing {
 public:
  CurveDrawing(const Axis& x, const Axis& y) : x_(x), y_(y) {}

  [[nodiscard]] double across(double x) const { return left + x_.share(x) * (right - left); }
  [[nodiscard]] double down(double y) const { return bottom - y_.share(y) * (bottom - top); }

  [[nodiscard]] std::string frame() const {
    std::string out = "<g class=\"axes\">";
    for (const double tick : x_.ticks()) {
      out +=
          fmt::format("<path d=\"M{0:.1f} {1}V{2}\"/><text x=\"{0:.1f}\" y=\"{3}\" text-anchor=\"middle\">{4}</text>",
                      across(tick), bottom, top, bottom + 18.0, tick_text(tick));
    }
    for (const double tick : y_.ticks(5)) {
      out += fmt::format("<path d=\"M{0} {2:.1f}H{1}\"/><text x=\"{3}\" y=\"{4:.1f}\" text-anchor=\"end\">{5}</text>",
                         left, right, down(tick), left - 6.0, down(tick) + 4.0, tick_text(tick));
    }
    out += fmt::format("<path class=\"frame\" d=\"M{} {}V{}H{}\"/>", left, top, bottom, right);
    out += fmt::format("<text class=\"label\" x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>", 0.5 * (left + right),
                       bottom + 42.0, escaped(x_.label));
    out +=
        fmt::format("<text class=\"label\" transform=\"translate(16 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
                    0.5 * (top + bottom), escaped(y_.label));
    return out + "</g>\n";
  }

  [[nodiscard]] std::string band(const SpreadCurve& curve, const Look& look) const {
    std::string there, back;
    for (std::size_t k = 0; k < curve.x.size(); ++k) {
      there += fmt::format("{}{:.1f} {:.1f}", k == 0 ? "M" : "L", across(curve.x[k]), down(curve.y[k].high));
      back = fmt::format("L{:.1f} {:.1f}", across(curve.x[k]), down(curve.y[k].low)) + back;
    }
    return fmt::format("<path class=\"band\" fill=\"{}\" d=\"{}{}Z\"/>\n", look.colour, there, back);
  }

  [[nodiscard]] std::string line(const SpreadCurve& curve, const Look& look) const {
    std::string path, points;
    for (std::size_t k = 0; k < curve.x.size(); ++k) {
      const double x = across(curve.x[k]), y = down(curve.y[k].median);
      path += fmt::format("{}{:.1f} {:.1f}", k == 0 ? "M" : "L", x, y);
      if (curve.shows_points) points += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2.6\"/>", x, y);
    }
    return fmt::format(
        "<path class=\"curve\" stroke=\"{0}\" stroke-dasharray=\"{1}\" d=\"{2}\"/><g fill=\"{0}\">{3}</g>\n",
        look.colour, look.dash, path, points);
  }

 private:
  const Axis& x_;
  const Axis& y_;
};

std::string legend(const std::vector<SpreadCurve>& curves) {
  std::string out = "<g class=\"legend\">";
  double at = left;
  const auto entry = [&](const std::string& mark, const std::string& words) {
    out += fmt::format("<g transform=\"translate({:.0f} 16)\">{}<text x=\"34\" y=\"4\">{}</text></g>", at, mark,
                       escaped(words));
    constexpr double mark_width = 56.0, letter_width = 6.6;
    at += mark_width + letter_width * static_cast<double>(words.size());
  };
  for (std::size_t c = 0; c < curves.size(); ++c) {
    const Look& look = looks[c % looks.size()];
    entry(fmt::format("<path class=\"curve\" stroke=\"{}\" stroke-dasharray=\"{}\" d=\"M0 0H28\"/>", look.colour,
                      look.dash),
          curves[c].name);
  }
  entry(fmt::format("<path class=\"band\" fill=\"{}\" d=\"M0 -6H28V6H0Z\"/>", looks[0].colour),
        "nine tenths of the channels");
  return out + "</g>\n";
}

}  // namespace

std::string curve_plot(const std::string& id, const std::string& about, Axis x, Axis y,
                       const std::vector<SpreadCurve>& curves) {
  for (const SpreadCurve& curve : curves) {
    for (const double at : curve.x) x.hold(at);
    for (const Spread& each : curve.y) {
      y.hold(each.low);
      y.hold(each.high);
    }
  }
  x.settle();
  y.settle();
  const CurveDrawing drawing(x, y);
  std::string out = svg_opening(id, width, height, about);
  for (std::size_t c = 0; c < curves.size(); ++c) out += drawing.band(curves[c], looks[c % looks.size()]);
  out += drawing.frame();
  for (std::size_t c = 0; c < curves.size(); ++c) out += drawing.line(curves[c], looks[c % looks.size()]);
  return out + legend(curves) + "</svg>\n";
}

}  // namespace compueye::firmware
