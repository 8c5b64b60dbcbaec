#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "recon/option_names.hpp"
#include "studies/accuracy_and_time/sweep_text.hpp"

namespace compueye::firmware {
namespace {

constexpr const char* header =
    "board,solver,basis,constraint,operator,precision,warm_motion,threads,iterations,times_board_noise,sigma,lambda,"
    "nmse_mean,"
    "nmse_p90,"
    "psnr_db_mean,psnr_db_p10,ssim_mean,ssim_p10,median_ms,p999_ms,timed_frames,table_bytes,workspace_bytes,"
    "efficient\r\n";

std::string quality_cells(const QualitySummary& q) {
  return fmt::format("{},{},{},{},{},{}", q.mean.nmse, q.nine_in_ten.nmse, q.mean.psnr_db, q.nine_in_ten.psnr_db,
                     q.mean.ssim, q.nine_in_ten.ssim);
}

/// One name of an operator has a comma in it.
std::string point_cells(const Sweep& s, const MeasuredPoint& p) {
  return fmt::format("{},{},{},{},\"{}\",{},{},{},{}", s.board, recon::name(p.curve.solver), recon::name(p.curve.basis),
                     recon::name(p.curve.constraint), recon::name(p.op),
                     p.curve.precision == recon::Precision::f64 ? "f64" : "f32", name(p.curve.motion), p.curve.threads,
                     p.iterations);
}

std::string cost_cells(const MeasuredPoint& p, bool efficient) {
  return fmt::format("{},{},{},{},{},{}", p.median_ms, p.p999_ms, p.timed_frames, p.table_bytes, p.workspace_bytes,
                     efficient ? 1 : 0);
}

}  // namespace

std::string sweep_csv(const Sweep& s) {
  std::string text = header;
  for (std::size_t level = 0; level < s.conventional.size(); ++level) {
    text += fmt::format("{},conventional eye,,,,,,,,{},{},,{},,,,,,\r\n", s.board, s.levels[level].times,
                        s.levels[level].sigma, quality_cells(s.conventional[level]));
  }
  std::vector<std::vector<std::size_t>> efficient;
  for (std::size_t level = 0; level <= s.levels.size(); ++level) efficient.push_back(efficient_points(s, level));
  const auto is_efficient = [&](std::size_t level, std::size_t i) {
    return std::find(efficient[level].begin(), efficient[level].end(), i) != efficient[level].end();
  };
  for (std::size_t i = 0; i < s.points.size(); ++i) {
    const MeasuredPoint& point = s.points[i];
    for (std::size_t level = 0; level < point.levels.size(); ++level) {
      const LevelFigures& figures = point.levels[level];
      text += fmt::format("{},{},{},{},{},{}\r\n", point_cells(s, point), figures.times, figures.sigma, figures.lambda,
                          quality_cells(figures.quality), cost_cells(point, is_efficient(level, i)));
    }
    text += fmt::format("{},all,,,{},{}\r\n", point_cells(s, point), quality_cells(point.overall),
                        cost_cells(point, is_efficient(s.levels.size(), i)));
  }
  return text;
}

}  // namespace compueye::firmware
