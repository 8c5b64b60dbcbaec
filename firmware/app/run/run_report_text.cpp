#include <fmt/format.h>

#include <array>
#include <string>
#include <string_view>

#include "firmware/app/run/run_report.hpp"
#include "firmware/text/number_text.hpp"
#include "firmware/text/table.hpp"
#include "firmware/text/visible_text.hpp"
#include "recon/option_names.hpp"

namespace compueye::firmware {
namespace {

std::string ms(std::int64_t ns) {
  return significant(static_cast<double>(ns) / 1e6, 3);
}

void add_times(Table& table, const std::string& what, const TimeStatistics& t) {
  if (t.count == 0) {
    table.add({what, "n/a", "n/a", "n/a", "n/a"});
    return;
  }
  table.add({what, ms(t.median_ns), ms(t.p90_ns), ms(t.p99_ns), ms(t.max_ns)});
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
               conventional[1], conventional[2], s.solve.count > 0 ? ms(s.solve.median_ns) : "n/a",
               std::to_string(s.frames.produced), std::to_string(s.frames.delivered),
               std::to_string(s.frames.total_dropped())});
}

}  // namespace compueye::firmware
