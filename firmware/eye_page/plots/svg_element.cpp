#include "firmware/eye_page/plots/svg_element.hpp"

#include <fmt/format.h>

#include <string_view>

#include "firmware/eye_page/plots/markup.hpp"

namespace compueye::firmware {
namespace {

constexpr std::string_view style = R"(
svg.plot text { font: 12.5px system-ui, sans-serif; fill: #1a1a1a; }
svg.plot text.label { font-size: 13.5px; }
svg.plot .small text { font-size: 11.5px; }
svg.plot .paper { fill: #eff3f7; }
svg.plot .axes path { stroke: #d0d0d0; stroke-width: 1; fill: none; }
svg.plot .frame, svg.plot .axes .frame { stroke: #333; stroke-width: 1; fill: none; }
svg.plot .band { fill-opacity: .2; stroke: none; }
svg.plot .curve { fill: none; stroke-width: 2; }
)";

}  // namespace

std::string svg_opening(const std::string& id, double width, double height, const std::string& about) {
  return fmt::format(
      "<svg id=\"{}\" class=\"plot\" xmlns=\"http://www.w3.org/2000/svg\" "
      "xmlns:xlink=\"http://www.w3.org/1999/xlink\" viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" "
      "aria-label=\"{}\">\n<style>{}</style>\n",
      escaped(id), width, height, escaped(about), style);
}

}  // namespace compueye::firmware
