#include "studies/comparison/comparison_files.hpp"

#include <fmt/format.h>

#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "firmware/sinks/contact_sheet.hpp"
#include "firmware/text/number_text.hpp"
#include "recon/option_names.hpp"

namespace compueye::firmware {
namespace {

constexpr int panel_pixels = 240;

std::vector<std::string> quality_lines(const PictureQuality& q) {
  return {fmt::format("NMSE {}", significant(q.nmse, 3)),
          fmt::format("{} dB, SSIM {}", fixed(q.psnr_db, 1), fixed(q.ssim, 2))};
}

Panel panel_of(const ComparedRow& row, bool best) {
  const Contender& c = row.contender;
  std::string title = fmt::format("{}{} {}", best ? "* " : "", name(c.basis), name(c.solver));
  if (c.constraint != recon::ConstraintKind::none) title += fmt::format(" {}", name(c.constraint));
  Panel panel{std::move(title), quality_lines(row.quality), row.picture};
  panel.figures.push_back(figures_of(row).sentence("K {iterations}, {solve_ms:3} ms"));
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

std::string cell(const Value& value) {
  return std::visit(
      [](const auto& held) -> std::string {
        using Held = std::decay_t<decltype(held)>;
        if constexpr (std::is_same_v<Held, std::string>) return held;
        if constexpr (std::is_same_v<Held, double>) return number(held);
        if constexpr (std::is_integral_v<Held>) return fmt::format("{}", held);
        return {};
      },
      value.data());
}

}  // namespace

std::string comparison_csv(const Comparison& c) {
  if (c.rows.empty()) return {};
  const auto line = [&](const Figures& row, const Figures& columns) {
    std::string text = fmt::format("{},{},{},{},{}", quoted(c.board), quoted(c.scene), c.scene_seed, c.seed,
                                   c.exact ? "exact" : "simulated eye");
    for (const auto& [key, ignored] : columns.members()) {
      const Value* value = row.find(key);
      text += ',' + (value == nullptr ? std::string() : cell(*value));
    }
    return text + "\r\n";
  };
  const Figures columns = figures_of(c.rows.front());
  std::string text = "board,scene,scene_seed,seed,samples";
  for (const auto& [key, ignored] : columns.members()) text += ',' + key;
  text += "\r\n";
  if (const auto& q = c.conventional_quality) {
    text +=
        line({{"solver", "conventional eye"}, {"nmse", q->nmse}, {"psnr_db", q->psnr_db}, {"ssim", q->ssim}}, columns);
  }
  for (const ComparedRow& row : c.rows) text += line(figures_of(row), columns);
  return text;
}

hal::Result<void> write_comparison_sheet(const std::string& path, const Comparison& c) {
  std::vector<Panel> panels;
  panels.push_back({"scene", {fmt::format("{} x {} pixels", c.truth.rows, c.truth.cols)}, c.truth});
  if (c.conventional && c.conventional_quality) {
    panels.push_back({"conventional eye", quality_lines(*c.conventional_quality), *c.conventional});
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
