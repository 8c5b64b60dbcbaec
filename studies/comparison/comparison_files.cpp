#include "studies/comparison/comparison_files.hpp"

#include <fmt/format.h>

#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "firmware/sinks/contact_sheet.hpp"
#include "firmware/text/number_text.hpp"
#include "recon/option_names.hpp"

namespace compueye::firmware {
namespace {

constexpr int panel_pixels = 240;

std::vector<std::string> figures_of(const PictureQuality& q) {
  return {fmt::format("NMSE {}", significant(q.nmse, 3)),
          fmt::format("{} dB, SSIM {}", fixed(q.psnr_db, 1), fixed(q.ssim, 2))};
}

Panel panel_of(const ComparedRow& row, bool best) {
  const Contender& c = row.contender;
  std::string title = fmt::format("{}{} {}", best ? "* " : "", name(c.basis), name(c.solver));
  if (c.constraint != recon::ConstraintKind::none) title += fmt::format(" {}", name(c.constraint));
  Panel panel{std::move(title), figures_of(row.quality), row.picture};
  panel.figures.push_back(fmt::format("K {}, {} ms", row.info.iterations, significant(row.solve_ms, 3)));
  return panel;
}

/// A scene may be a file name with a comma in it.
std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char character : text) out += character == '"' ? std::string("\"\"") : std::string(1, character);
  return out + '"';
}

/// The shortest digits that come back as the same number, with a point or an exponent even where it is whole.
std::string number(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_not_of("-0123456789") == std::string::npos) text += ".0";
  return text;
}

std::string cell(const ComparedFigure::Value& value) {
  if (const auto* word = std::get_if<std::string_view>(&value)) return std::string(*word);
  if (const auto* count = std::get_if<std::int64_t>(&value)) return fmt::format("{}", *count);
  if (const auto* figure = std::get_if<double>(&value)) return number(*figure);
  return {};
}

/// The conventional eye as a row with the columns of `like`.
std::vector<ComparedFigure> conventional_row(const PictureQuality& quality, std::vector<ComparedFigure> like) {
  for (ComparedFigure& figure : like) {
    figure.value = {};
    if (figure.key == "solver") figure.value = "conventional eye";
    if (figure.key == "nmse") figure.value = quality.nmse;
    if (figure.key == "psnr_db") figure.value = quality.psnr_db;
    if (figure.key == "ssim") figure.value = quality.ssim;
  }
  return like;
}

}  // namespace

std::string comparison_csv(const Comparison& c) {
  const auto line = [&](const std::vector<ComparedFigure>& row) {
    std::string text = fmt::format("{},{},{},{},{}", quoted(c.board), quoted(c.scene), c.scene_seed, c.seed,
                                   c.exact ? "exact" : "simulated eye");
    for (const ComparedFigure& figure : row) text += ',' + cell(figure.value);
    return text + "\r\n";
  };
  std::string text;
  for (const ComparedRow& row : c.rows) {
    const std::vector<ComparedFigure> figures = figures_of(row);
    if (text.empty()) {
      text = "board,scene,scene_seed,seed,samples";
      for (const ComparedFigure& figure : figures) text += fmt::format(",{}", figure.key);
      text += "\r\n";
      if (c.conventional_quality) text += line(conventional_row(*c.conventional_quality, figures));
    }
    text += line(figures);
  }
  return text;
}

hal::Result<void> write_comparison_sheet(const std::string& path, const Comparison& c) {
  std::vector<Panel> panels;
  panels.push_back({"scene", {fmt::format("{} x {} pixels", c.truth.rows, c.truth.cols)}, c.truth});
  if (c.conventional && c.conventional_quality) {
    panels.push_back({"conventional eye", figures_of(*c.conventional_quality), *c.conventional});
  }
  const ComparedRow* best = best_of(c);
  const ComparedRow* before = nullptr;
  for (const ComparedRow& row : c.rows) {
    panels.push_back(panel_of(row, &row == best));
    panels.back().begins_row = before == nullptr || before->contender.basis != row.contender.basis;
    before = &row;
  }
  const std::string title = fmt::format("{}: {}, {}, noise {}", c.board, c.scene,
                                        c.exact ? "y = A x + n" : "through the simulated eye", significant(c.sigma, 3));
  return write_contact_sheet(path, title, panels, panel_pixels);
}

}  // namespace compueye::firmware
