#include "studies/accuracy_and_time/sweep_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <vector>

#include "firmware/operating_points/stored_points.hpp"
#include "hal/try.hpp"
#include "recon/option_names.hpp"
#include "studies/accuracy_and_time/gnuplot_script.hpp"
#include "studies/plots/gnuplot.hpp"

namespace compueye::firmware {
namespace {

using hal::Result;

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
                     recon::name(p.curve.constraint), recon::name(p.op), recon::name(p.curve.precision),
                     name(p.curve.motion), p.curve.threads, p.iterations);
}

std::string cost_cells(const MeasuredPoint& p, bool efficient) {
  return fmt::format("{},{},{},{},{},{}", p.median_ms, p.p999_ms, p.timed_frames, p.table_bytes, p.workspace_bytes,
                     efficient ? 1 : 0);
}

/// At one noise level, or over all of them after the last.
void tell_level(const Sweep& s, std::size_t level, Figures& f) {
  const std::string at = level < s.levels.size() ? fmt::format("levels.{}", level) : "overall";
  Value::List rows;
  if (level < s.conventional.size()) {
    rows.push_back(Figures{{"title", "conventional eye"}, {"quality", *f.find(fmt::format("conventional.{}", level))}});
  }
  for (const std::size_t i : efficient_points(s, level)) {
    const MeasuredPoint& point = s.points[i];
    const std::string quality = level < point.levels.size() ? fmt::format("levels.{}.quality", level) : "overall";
    rows.push_back(Figures{{"title", title(point.curve)},
                           {"point", *f.find(fmt::format("points.{}", i))},
                           {"quality", *f.find(fmt::format("points.{}.{}", i, quality))},
                           {"memory", point.table_bytes + point.workspace_bytes}});
  }
  f.tell(level < s.levels.size()
             ? "\nnoise {" + at + ".times_board_noise:3} times the board's, sigma {" + at + ".sigma:3} white pixels\n"
             : "\nall noise levels together\n");
  f.say(table_of(rows,
                 {{"efficient point", "{title}", Align::left},
                  {"iterations", "{point.iterations:,}"},
                  {"NMSE", "{quality.mean.nmse:3}"},
                  {"9 in 10", "{quality.nine_in_ten.nmse:3}"},
                  {"PSNR dB", "{quality.mean.psnr_db:.2}"},
                  {"9 in 10", "{quality.nine_in_ten.psnr_db:.2}"},
                  {"SSIM", "{quality.mean.ssim:.3}"},
                  {"9 in 10", "{quality.nine_in_ten.ssim:.3}"},
                  {"ms", "{point.median_ms:3}"},
                  {"99.9 %", "{point.p999_ms:3}"},
                  {"frames", "{point.timed_frames:,}"},
                  {"memory", "{memory:bytes}"}},
                 ""));
}

void tell_foot(const Sweep& s, Figures& f) {
  f.tell(
      "\nEfficient: better by a hundredth of NMSE than each of the {points:count} points that is as fast. ms: median; "
      "99.9 %:\npercentile of the timed frames (their number beside it; of fewer than 1000 it is the slowest). 9 in "
      "10: what nine of ten scenes reach. memory: tables and workspace.\n");
  if (!s.cut_short.empty()) f.tell("Partial: {cut_short}; {points:count} of at most {planned} points were measured.\n");
  std::set<std::string> said;
  for (const std::string& note : s.notes) {
    if (said.insert(note).second) f.say("note: " + note + "\n");
  }
}

}  // namespace

Figures sweep_report(const Sweep& sweep) {
  Figures f = figures_of(sweep);
  f.tell(
      "{board}: {seeing_channels:,} of {channels:,} ommatidia see its {rows} x {cols} pixels; {machine.cores} cores of "
      "{machine.cpu}, one in use where no threads are named\n"
      "{pictures_a_level} scenes ({scenes}, seeds from {first_scene_seed}) at {levels:count} noise "
      "level[{levels.1:'s'}], "
      "through the simulated eye; lambda by rule from sigma\n");
  for (std::size_t level = 0; level < sweep.levels.size(); ++level) tell_level(sweep, level, f);
  if (sweep.levels.size() > 1) tell_level(sweep, sweep.levels.size(), f);
  tell_foot(sweep, f);
  return f;
}

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

std::string plot_stem(const NoiseLevel& level) {
  return "pareto-noise-" + fmt::format("{:g}", level.times);
}

Result<bool> write_plots(const std::string& folder, const Sweep& sweep) {
  bool drawn = true;
  for (std::size_t level = 0; level < sweep.levels.size(); ++level) {
    const std::string stem = plot_stem(sweep.levels[level]);
    // Without gnuplot the other scripts are worth having all the same.
    drawn = TRY(write_plot(folder, stem, gnuplot_script(sweep, level, stem), "pareto.csv")) && drawn;
  }
  return drawn;
}

}  // namespace compueye::firmware
