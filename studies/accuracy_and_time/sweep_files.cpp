#include "studies/accuracy_and_time/sweep_files.hpp"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <set>
#include <span>
#include <system_error>
#include <vector>

#include "firmware/files/atomic_file.hpp"
#include "firmware/text/number_text.hpp"
#include "firmware/text/table.hpp"
#include "hal/try.hpp"
#include "recon/option_names.hpp"
#include "studies/accuracy_and_time/gnuplot_script.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::Result;

constexpr int not_started = 127;

/// Its exit code, 127 when there is none to start.
int run_gnuplot(const std::string& folder, const std::string& script) {
  std::string program = "gnuplot", argument = script;
  std::array<char*, 3> words{program.data(), argument.data(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", 0, 0);
  pid_t process = -1;
  const int failed = posix_spawnp(&process, program.c_str(), &actions, nullptr, words.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) return not_started;
  int status = 0;
  while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

Result<void> publish(const std::string& file) {
  std::error_code ec;
  std::filesystem::rename(file + ".partial", file, ec);
  if (!ec) return {};
  return hal::fail(ErrorCode::io, file, "was not drawn by gnuplot: " + ec.message());
}

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
    const std::string stem = plot_stem(sweep.levels[level]), file = folder + '/' + stem;
    const std::string script = gnuplot_script(sweep, level, stem);
    TRY(write_file_atomically(file + ".gnuplot", std::as_bytes(std::span(script))));
    // Without gnuplot the other scripts are worth having all the same.
    const int code = drawn ? run_gnuplot(folder, stem + ".gnuplot") : not_started;
    drawn = code != not_started;
    if (!drawn) continue;
    if (code != 0) {
      return hal::fail(ErrorCode::io, file + ".gnuplot",
                       fmt::format("gnuplot ended with exit code {}; pareto.csv has every point", code));
    }
    for (const char* ending : {".svg", ".png"}) TRY(publish(file + ending));
  }
  return drawn;
}

}  // namespace compueye::firmware
