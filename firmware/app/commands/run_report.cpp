#include "firmware/app/commands/run_report.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdlib>
#include <string>
#include <string_view>
#include <utility>

#include "firmware/text/number_text.hpp"
#include "firmware/text/table.hpp"
#include "firmware/text/words.hpp"
#include "recon/option_names.hpp"

namespace compueye::firmware {
namespace {

double ms(std::int64_t ns) {
  return static_cast<double>(ns) / 1e6;
}

std::string ms_text(std::int64_t ns) {
  return significant(ms(ns), 3);
}

void add_times(Table& table, const std::string& what, const TimeStatistics& t) {
  if (t.count == 0) {
    table.add({what, "n/a", "n/a", "n/a", "n/a"});
    return;
  }
  table.add({what, ms_text(t.median_ns), ms_text(t.p90_ns), ms_text(t.p99_ns), ms_text(t.max_ns)});
}

std::string times_text(const RunSummary& s) {
  Table table({{"ms a frame", Align::left}, {"median"}, {"p90"}, {"p99"}, {"max"}});
  add_times(table, "solve", s.solve);
  add_times(table, "age", s.age);
  return table.text();
}

std::string drops_text(const hal::FrameAccount& account) {
  std::string text;
  for (std::size_t r = 0; r < hal::drop_reason_count; ++r) {
    const auto reason = static_cast<hal::DropReason>(r);
    if (account.drops(reason) == 0) continue;
    text += fmt::format("{}{} {}", text.empty() ? " (" : ", ", account.drops(reason), hal::name(reason));
  }
  return text.empty() ? text : text + ")";
}

std::string times(std::uint64_t count) {
  return count == 1 ? "once" : fmt::format("{} times", count);
}

/// "stepped down 2 times and up once; frames of ..."
std::string steps_text(const LadderReport& report) {
  std::string text =
      fmt::format("stepped down {} and up {}; frames of", times(report.steps_down), times(report.steps_up));
  for (std::size_t r = 0; r < report.rungs.size(); ++r) {
    text += fmt::format("{} {}: {}", r > 0 ? "," : "", report.rungs[r].point, report.rungs[r].frames);
  }
  return text;
}

std::string eye_text(const RunReport& report) {
  const EyeFigures& e = report.eye;
  std::string text = fmt::format("{} ({}): {} ommatidia, {} blind", e.board, e.source, e.ommatidia, e.blind);
  if (e.dead > 0) text += fmt::format(", {} dead", e.dead);
  text += fmt::format("; {} x {} pixels; scene {} at {:g} mm, seed {}\n", e.image_rows, e.image_cols,
                      visible_text(report.scene), report.distance_mm, report.seed);
  text += fmt::format("{}, {}, {} iterations, lambda {}{}, rho {}\n", name(e.point.solver), name(e.point.basis),
                      e.point.iterations, significant(e.lambda.value, 3),
                      e.lambda.by_rule ? " by rule from sigma " + significant(e.lambda.sigma, 3) : " as given",
                      significant(e.rho, 3));
  text += fmt::format("set up in {}, factor {}; memory: workspace {}, tables {}\n", duration(report.setup_s),
                      name(e.factor), bytes(e.workspace_bytes), bytes(e.table_bytes));
  return text;
}

std::string frames_text(const RunReport& report) {
  const RunSummary& s = report.summary;
  std::string text = fmt::format("frames: {} produced = {} delivered + {} dropped{}; {}; ended: {} after {}\n",
                                 s.frames.produced, s.frames.delivered, s.frames.total_dropped(), drops_text(s.frames),
                                 report.lossless ? "lossless" : "live", name(s.ending),
                                 duration(static_cast<double>(s.wall_ns) / 1e9));
  if (report.deadline) {
    text += report.deadline->sentence() + "\n";
  }
  if (report.ladder) text += report.ladder->sentence + "\n" + steps_text(*report.ladder) + "\n";
  if (report.deadline || report.ladder) {
    text += fmt::format("deadline misses: {} of {}\n", s.deadline_misses, s.frames.delivered);
  }
  return text;
}

std::string health_text(const RunSummary& s) {
  std::string text =
      fmt::format("health: {} converged, {} used their budget", s.health.converged, s.health.budget_used);
  const auto add = [&](std::uint64_t count, std::string_view what) {
    if (count > 0) text += fmt::format(", {} {}", count, what);
  };
  add(s.health.saturated_frames, "with saturated channels");
  add(s.health.overrun_flags, "with overrun flags");
  add(s.health.dark_frames, "dark");
  add(s.health.untrusted_times, "with an untrusted time");
  add(s.health.config_mismatches, "with another configuration");
  add(s.health.read_timeouts, "reads timed out");
  if (s.masked_max > 0) text += fmt::format("; {} to {} channels masked", s.masked_min, s.masked_max);
  if (const std::string counters = hal::text_of(s.source_counters); !counters.empty()) text += "\nsource: " + counters;
  return text + "\n";
}

std::string quality_text(const RunReport& report) {
  if (!report.quality) return {};
  Table table({{"against the scene", Align::left}, {"NMSE"}, {"PSNR dB"}, {"SSIM"}});
  const auto add = [&](const std::string& what, const std::optional<PictureQuality>& q) {
    if (q) table.add({what, significant(q->nmse, 3), fixed(q->psnr_db, 1), fixed(q->ssim, 3)});
  };
  add(fmt::format("reconstruction, mean of {}", report.measured), report.quality);
  add("conventional eye, one frame", report.conventional);
  return table.text();
}

/// Of a table whose rows are printed by different processes: widths are agreed, not measured.
struct FixedColumn {
  std::string_view title;
  int width;  // negative: left
};
constexpr std::array<FixedColumn, 12> columns{{{"eye", -12},
                                               {"scene", -10},
                                               {"NMSE", 8},
                                               {"PSNR dB", 8},
                                               {"SSIM", 6},
                                               {"conv NMSE", 10},
                                               {"conv PSNR", 10},
                                               {"conv SSIM", 10},
                                               {"ms a frame", 11},
                                               {"produced", 9},
                                               {"delivered", 10},
                                               {"dropped", 8}}};

std::string line(const std::array<std::string, columns.size()>& cells) {
  std::string text;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const auto width = static_cast<std::size_t>(std::abs(columns[i].width));
    text += columns[i].width < 0 ? fmt::format("{:<{}}", cells[i], width) : fmt::format("{:>{}}", cells[i], width);
    if (columns[i].width < 0) text += ' ';
  }
  return text + "\n";
}

Figures times_figures(const TimeStatistics& times) {
  return {{"count", times.count},    {"min", ms(times.min_ns)}, {"median", ms(times.median_ns)},
          {"p90", ms(times.p90_ns)}, {"p99", ms(times.p99_ns)}, {"max", ms(times.max_ns)}};
}

Value quality_figures(const std::optional<PictureQuality>& quality) {
  if (!quality) return {};
  return Figures{{"nmse", quality->nmse}, {"psnr_db", quality->psnr_db}, {"ssim", quality->ssim}};
}

Figures eye_figures(const EyeFigures& eye) {
  return {{"board", eye.board},
          {"source", eye.source},
          {"ommatidia", eye.ommatidia},
          {"blind_ommatidia", eye.blind},
          {"dead_ommatidia", eye.dead},
          {"image_rows", eye.image_rows},
          {"image_columns", eye.image_cols},
          {"frame_rate_hz", eye.frame_rate_hz}};
}

Figures point_figures(const EyeFigures& eye) {
  return {{"solver", name(eye.point.solver)},
          {"basis", name(eye.point.basis)},
          {"operator", name(eye.point.op)},
          {"precision", eye.point.precision == recon::Precision::f32 ? "f32" : "f64"},
          {"iterations", eye.point.iterations},
          {"lambda", eye.lambda.value},
          {"lambda_by_rule", eye.lambda.by_rule},
          {"sigma", eye.lambda.by_rule ? Value(eye.lambda.sigma) : Value()},
          {"rho", eye.rho}};
}

Figures ladder_figures(const LadderReport& report, std::uint64_t misses) {
  Value::List points;
  for (const LadderReport::Rung& rung : report.rungs) {
    points.push_back(
        Figures{{"point", rung.point}, {"nmse", rung.nmse}, {"p999_ms", rung.p999_ms}, {"frames", rung.frames}});
  }
  return {{"deadline_ms", report.deadline_ms},
          {"fits", report.fits},
          {"chosen_by", "stored points"},
          {"predicted_age_ms", report.age_ms},
          {"memory_bytes", report.memory_bytes},
          {"points", std::move(points)},
          {"steps_down", report.steps_down},
          {"steps_up", report.steps_up},
          {"misses", misses}};
}

Value deadline_figures(const RunReport& report) {
  const std::uint64_t misses = report.summary.deadline_misses;
  if (report.ladder) return ladder_figures(*report.ladder, misses);
  const std::optional<DeadlineChoice>& choice = report.deadline;
  if (!choice) return {};
  return Figures{{"deadline_ms", choice->deadline_ms},
                 {"fits", choice->fits},
                 {"chosen_by", "trial"},
                 {"iterations", choice->iterations},
                 {"most_iterations", choice->most_iterations},
                 {"predicted_solve_ms", choice->solve_ms},
                 {"predicted_age_ms", choice->age_ms},
                 {"shortest_deadline_ms", choice->least_ms},
                 {"deadline_for_most_iterations_ms", choice->for_most_ms},
                 {"misses", misses}};
}

Figures health_figures(const RunSummary& s) {
  return {{"converged", s.health.converged},
          {"budget_used", s.health.budget_used},
          {"read_timeouts", s.health.read_timeouts},
          {"overrun_flags", s.health.overrun_flags},
          {"saturated_frames", s.health.saturated_frames},
          {"dark_frames", s.health.dark_frames},
          {"untrusted_times", s.health.untrusted_times},
          {"config_mismatches", s.health.config_mismatches},
          {"masked_channels_min", s.masked_min},
          {"masked_channels_max", s.masked_max}};
}

Figures counter_figures(const std::vector<hal::Counter>& counters) {
  Figures figures;
  for (const hal::Counter& each : counters) figures.add(each.name, each.count);
  return figures;
}

Value last_figures(const RunReport& report) {
  const RunSummary& s = report.summary;
  if (!s.last) return {};
  return Figures{{"frame", s.last_frame},
                 {"objective", s.last->objective},
                 {"residual", s.last->residual},
                 {"primal_residual", s.last->primal_residual},
                 {"dual_residual", s.last->dual_residual},
                 {"channels_used", s.last->channels_used},
                 {"channels_reweighted", s.last->channels_reweighted},
                 {"quality", quality_figures(report.last_quality)}};
}

Figures stage_figures(const StageAccounts& accounts) {
  return {{"source", figures_of(accounts.source)},
          {"acquire", figures_of(accounts.acquire)},
          {"correct", figures_of(accounts.correct)},
          {"reconstruct", figures_of(accounts.reconstruct)},
          {"publish", figures_of(accounts.publish)}};
}

}  // namespace

std::string report_text(const RunReport& report) {
  return eye_text(report) + frames_text(report) + health_text(report.summary) + "\n" + times_text(report.summary) +
         "\n" + quality_text(report);
}

std::string table_header() {
  std::array<std::string, columns.size()> titles;
  std::size_t width = 0;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    titles[i] = columns[i].title;
    width += static_cast<std::size_t>(std::abs(columns[i].width)) + (columns[i].width < 0 ? 1U : 0U);
  }
  return line(titles) + std::string(width, '-') + "\n";
}

std::string table_row(const RunReport& report) {
  const auto figures = [](const std::optional<PictureQuality>& q) {
    if (!q) return std::array<std::string, 3>{"n/a", "n/a", "n/a"};
    return std::array<std::string, 3>{significant(q->nmse, 3), fixed(q->psnr_db, 1), fixed(q->ssim, 3)};
  };
  const auto ours = figures(report.quality), conventional = figures(report.conventional);
  const RunSummary& s = report.summary;
  return line({report.eye.board, visible_text(report.scene), ours[0], ours[1], ours[2], conventional[0],
               conventional[1], conventional[2], s.solve.count > 0 ? ms_text(s.solve.median_ns) : "n/a",
               std::to_string(s.frames.produced), std::to_string(s.frames.delivered),
               std::to_string(s.frames.total_dropped())});
}

Figures report_figures(const RunReport& report) {
  const RunSummary& s = report.summary;
  Figures figures{
      {"eye", eye_figures(report.eye)},
      {"scene", report.scene},
      {"seed", report.seed},
      {"distance_mm", report.distance_mm},
      {"pacing", report.lossless ? "lossless" : "live"},
      {"operating_point", point_figures(report.eye)},
      {"factor", name(report.eye.factor)},
      {"memory", Figures{{"workspace_bytes", report.eye.workspace_bytes}, {"table_bytes", report.eye.table_bytes}}},
      {"setup_s", report.setup_s},
      {"ending", name(s.ending)},
      {"frames", figures_of(s.frames)},
      {"stages", stage_figures(s.stages)},
      {"wall_s", ms(s.wall_ns) / 1e3},
      {"solve_ms", times_figures(s.solve)},
      {"age_ms", times_figures(s.age)},
      {"correct_ms", times_figures(s.correct)},
      {"write_ms", times_figures(s.write)},
      {"deadline", deadline_figures(report)},
      {"health", health_figures(s)},
      {"source_counters", counter_figures(s.source_counters)},
      {"quality", quality_figures(report.quality)},
      {"quality_frames", report.measured},
      {"conventional", quality_figures(report.conventional)},
      {"last", last_figures(report)},
      {"files", report.files},
      {"notes", report.notes}};
  if (s.error) figures.add("error", figures_of(*s.error));
  return figures;
}

}  // namespace compueye::firmware
