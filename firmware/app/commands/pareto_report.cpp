#include "firmware/app/commands/pareto_report.hpp"

#include <fmt/format.h>

#include <set>

#include "firmware/text/number_text.hpp"
#include "firmware/text/table.hpp"

namespace compueye::firmware {
namespace {

std::string head_text(const Sweep& s) {
  return fmt::format(
      "{}: {} of {} ommatidia see its {} x {} pixels; {} cores of {}, one in use where no threads are named\n"
      "{} scenes ({}, seeds from {}) at {} noise levels, through the simulated eye; lambda by rule from sigma\n",
      s.board, grouped(s.seeing), grouped(s.channels), s.image_rows, s.image_cols, s.machine.cores, s.machine.cpu,
      s.pictures_a_level, fmt::join(s.scenes, ", "), s.first_scene_seed, s.levels.size());
}

std::vector<std::string> cells_of(const std::string& name, const std::string& iterations, const QualitySummary& q) {
  return {name,
          iterations,
          significant(q.mean.nmse, 3),
          significant(q.nine_in_ten.nmse, 3),
          fixed(q.mean.psnr_db, 2),
          fixed(q.nine_in_ten.psnr_db, 2),
          fixed(q.mean.ssim, 3),
          fixed(q.nine_in_ten.ssim, 3)};
}

std::string level_text(const Sweep& s, std::size_t level) {
  Table table({{"efficient point", Align::left},
               {"iterations"},
               {"NMSE"},
               {"9 in 10"},
               {"PSNR dB"},
               {"9 in 10"},
               {"SSIM"},
               {"9 in 10"},
               {"ms"},
               {"99.9 %"},
               {"frames"},
               {"memory"}});
  if (level < s.conventional.size()) table.add(cells_of("conventional eye", "", s.conventional[level]));
  for (const std::size_t i : efficient_points(s, level)) {
    const MeasuredPoint& point = s.points[i];
    const QualitySummary& quality = level < point.levels.size() ? point.levels[level].quality : point.overall;
    auto cells = cells_of(title(point.curve), grouped(point.iterations), quality);
    cells.insert(cells.end(), {significant(point.median_ms, 3), significant(point.p999_ms, 3),
                               grouped(static_cast<std::int64_t>(point.timed_frames)),
                               bytes(point.table_bytes + point.workspace_bytes)});
    table.add(std::move(cells));
  }
  const std::string head =
      level < s.levels.size()
          ? fmt::format("\nnoise {} times the board's, sigma {} white pixels\n", significant(s.levels[level].times, 3),
                        significant(s.levels[level].sigma, 3))
          : std::string("\nall noise levels together\n");
  return head + table.text();
}

std::string foot_text(const Sweep& s) {
  std::string text = fmt::format(
      "\nEfficient: better by a hundredth of NMSE than each of the {} points that is as fast. ms: median; 99.9 %:\n"
      "percentile of the timed frames (their number beside it; of fewer than 1000 it is the slowest). 9 in 10: what "
      "nine of ten scenes reach. memory: tables and workspace.\n",
      s.points.size());
  if (!s.cut_short.empty()) {
    text +=
        fmt::format("Partial: {}; {} of at most {} points were measured.\n", s.cut_short, s.points.size(), s.planned);
  }
  std::set<std::string> said;
  for (const std::string& note : s.notes) {
    if (said.insert(note).second) text += "note: " + note + "\n";
  }
  return text;
}

}  // namespace

std::string sweep_text(const Sweep& sweep) {
  std::string text = head_text(sweep);
  for (std::size_t level = 0; level < sweep.levels.size(); ++level) text += level_text(sweep, level);
  if (sweep.levels.size() > 1) text += level_text(sweep, sweep.levels.size());
  return text + foot_text(sweep);
}

}  // namespace compueye::firmware
