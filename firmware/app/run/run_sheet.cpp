#include "firmware/app/run/run_sheet.hpp"

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "firmware/sinks/contact_sheet.hpp"
#include "firmware/text/number_text.hpp"
#include "recon/option_names.hpp"

namespace compueye::firmware {
namespace {

std::vector<std::string> figures_of(const std::optional<PictureQuality>& q) {
  if (!q) return {};
  return {"NMSE " + significant(q->nmse, 3), "PSNR " + fixed(q->psnr_db, 1) + " dB", "SSIM " + fixed(q->ssim, 3)};
}

std::string title_of(const RunReport& report) {
  return fmt::format("{}: {} at {:g} mm", report.eye.board, report.scene, report.distance_mm);
}

}  // namespace

hal::Result<void> write_run_sheet(const std::filesystem::path& path, const RunReport& report, const hal::Image& truth,
                                  const hal::Image& conventional, const hal::Image& last) {
  const EyeFigures& eye = report.eye;
  std::vector<Panel> panels;
  panels.push_back({"scene", {fmt::format("{} x {} pixels", truth.rows, truth.cols)}, truth});
  if (!conventional.pixels.empty())
    panels.push_back({"conventional eye", figures_of(report.conventional), conventional});
  Panel ours{fmt::format("reconstruction, frame {}", report.summary.last_frame), figures_of(report.last_quality), last};
  ours.figures.push_back(
      fmt::format("{}, {}, {} iterations", name(eye.point.solver), name(eye.point.basis), eye.point.iterations));
  panels.push_back(std::move(ours));
  auto error = error_panel(last, truth);
  if (!error) return tl::unexpected(std::move(error.error()));
  panels.push_back(std::move(*error));
  return write_contact_sheet(path, title_of(report), panels);
}

}  // namespace compueye::firmware
