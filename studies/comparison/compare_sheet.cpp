#include "studies/comparison/compare_sheet.hpp"

#include <fmt/format.h>

#include <string>
#include <utility>
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

}  // namespace

hal::Result<void> write_compare_sheet(const std::filesystem::path& path, const Comparison& c) {
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
