#include "firmware/eye_page/eye_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "firmware/eye_page/plots/axis.hpp"
#include "firmware/eye_page/plots/markup.hpp"
#include "firmware/eye_page/plots/spread.hpp"
#include "firmware/eye_page/section_list.hpp"
#include "firmware/text/number_text.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

constexpr std::string_view page_style = R"(
body { font: 15px/1.5 system-ui, sans-serif; color: #1a1a1a; background: #fff; max-width: 60em; margin: 2em auto;
  padding: 0 1em; }
h1 { font-size: 1.7em; margin-bottom: 0; } h2 { font-size: 1.2em; margin: 2.2em 0 .4em; border-bottom: 1px solid #bbb; }
table { border-collapse: collapse; margin: .6em 0 1em; font-size: .9em; }
th, td { text-align: left; padding: .2em .8em .2em 0; border-bottom: 1px solid #ddd; vertical-align: top;
  unicode-bidi: isolate; overflow-wrap: anywhere; }
.number { text-align: right; white-space: nowrap; font-variant-numeric: tabular-nums; }
svg.plot { display: block; width: 100%; max-width: 720px; height: auto; margin: .5em 0; }
.figures { font-weight: 600; margin: .3em 0; } .look-for, .missing { color: #444; margin: .3em 0; }
pre { background: #f4f4f4; padding: .6em; overflow-x: auto; }
nav a { margin-right: 1em; } a { color: #005a94; }
@media print { section { break-inside: avoid; } nav, details { display: none; } body { font-size: 12px; margin: 0; } }
)";

/// The file at a glance.
std::string summary(const PageData& data) {
  const calib::EyeIdentity& eye = data.eye;
  constexpr double deg = std::numbers::pi / 180.0;
  std::string out =
      fmt::format("{}x{} ommatidia {} deg apart, {} deg acceptance, {} lattice, before {}x{} pixels on {}x{} mm. ",
                  eye.geometry.rows, eye.geometry.columns, tick_text(eye.geometry.interommatidial_rad / deg),
                  tick_text(eye.geometry.acceptance_rad / deg), hal::name(eye.geometry.lattice), eye.plane.rows,
                  eye.plane.cols, tick_text(eye.plane.height_mm), tick_text(eye.plane.width_mm));
  std::int64_t captures = 0;
  for (const PageSession& session : data.sessions) captures += session.captures;
  out += fmt::format("Sessions: {}, captures: {}, estimates: {}.", data.sessions.size(), grouped(captures),
                     data.estimates.size());
  if (!data.newest) return out;
  const auto& status = data.newest->estimate.status;
  out += fmt::format(" Of {} channels {} are good.", status.size(),
                     std::count(status.begin(), status.end(), hal::ChannelStatus::good));
  if (const auto error = spread_of(data.newest->row_error)) {
    out += fmt::format(" The median row is known to {} %.", significant(100.0 * error->median, 2));
  }
  return out;
}

hal::Result<std::string> section_text(const PageSection& section, const PageData& data) {
  const std::string drawn = TRY(section.draw(data));
  const std::string inside = drawn.empty() ? "<p class=\"missing\">" + escaped(section.missing) + "</p>\n"
                                           : drawn + "<p class=\"look-for\">" + escaped(section.look_for) + "</p>\n";
  return fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n{}</section>\n", section.id, escaped(section.title), inside);
}

}  // namespace

hal::Result<std::string> eye_page(const PageData& data) {
  const std::string title =
      "Eye " + (data.eye.serial.empty() ? std::string("without a serial") : "'" + escaped(data.eye.serial) + "'");
  std::string out =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width\">\n<title>" +
      title + "</title>\n<style>" + std::string(page_style) + "</style>\n</head>\n<body>\n<h1>" + title + "</h1>\n<p>" +
      escaped(data.file) + "</p>\n<p>" + escaped(summary(data)) + "</p>\n<nav>";
  for (const PageSection& section : page_sections()) {
    out += fmt::format("<a href=\"#{}\">{}</a>\n", section.id, escaped(section.title));
  }
  out += "</nav>\n";
  for (const PageSection& section : page_sections()) out += TRY(section_text(section, data));
  return out + "</body>\n</html>\n";
}

}  // namespace compueye::firmware
