#include "firmware/app/commands/run_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string>
#include <string_view>
#include <utility>

#include "firmware/text/number_text.hpp"
#include "firmware/text/words.hpp"
#include "recon/option_names.hpp"

namespace compueye::firmware {
namespace {

double ms(std::int64_t ns) {
  return static_cast<double>(ns) / 1e6;
}

std::string times(std::uint64_t count) {
  return count == 1 ? "once" : fmt::format("{} times", count);
}

Figures eye_figures(const Board& board, const ReadyEye& eye, const std::string& source) {
  const auto& sees = eye.sees();
  const auto masked = static_cast<std::ptrdiff_t>(eye.measured() != nullptr ? eye.measured()->masked() : 0);
  return {{"board", board.name},
          {"source", source},
          {"ommatidia", board.eye.ommatidia()},
          {"blind_ommatidia", std::count(sees.begin(), sees.end(), 0) - masked},
          {"masked_ommatidia", masked},
          {"dead_ommatidia", board.sensor.dead.size()},
          {"image_rows", eye.reconstructor().image_rows()},
          {"image_columns", eye.reconstructor().image_cols()},
          {"frame_rate_hz", board.source.frame_rate_hz}};
}

Figures point_figures(const ReadyEye& eye) {
  const recon::OperatingPoint point = eye.reconstructor().operating_point();
  const LambdaChoice& lambda = eye.lambda();
  const bool by_hand = lambda.origin == LambdaOrigin::hand;
  return {{"solver", name(point.solver)},
          {"basis", name(point.basis)},
          {"operator", name(point.op)},
          {"precision", name(point.precision)},
          {"iterations", point.iterations},
          {"lambda", lambda.value},
          {"lambda_by", name(lambda.origin)},
          {"lambda_by_rule", lambda.origin == LambdaOrigin::rule},
          {"rule_lambda", by_hand ? Value() : Value(lambda.rule)},
          {"lambda_over_rule", by_hand ? Value() : Value(lambda.value / lambda.rule)},
          {"sigma", by_hand ? Value() : Value(lambda.sigma)},
          {"huber", eye.reconstructor().objective().huber},
          {"rho", eye.reconstructor().plan().rho}};
}

Figures times_figures(const TimeStatistics& times) {
  return {{"count", times.count},    {"min", ms(times.min_ns)}, {"median", ms(times.median_ns)},
          {"p90", ms(times.p90_ns)}, {"p99", ms(times.p99_ns)}, {"max", ms(times.max_ns)}};
}

Figures ladder_figures(const LadderRun& ladder, std::uint64_t misses) {
  Value::List rungs;
  for (std::size_t r = 0; r < ladder.choice.ladder.size(); ++r) {
    const MeasuredPoint& point = ladder.points.points[ladder.choice.ladder[r]];
    rungs.push_back(Figures{{"point", point_text(point)},
                            {"nmse", point.levels[ladder.choice.level].quality.mean.nmse},
                            {"p999_ms", point.p999_ms},
                            {"frames", r < ladder.frames.size() ? ladder.frames[r] : 0}});
  }
  return {{"deadline_ms", ladder.choice.deadline_ms},
          {"fits", ladder.choice.fits},
          {"chosen_by", "stored points"},
          {"predicted_age_ms", ladder.choice.age_ms},
          {"memory_bytes", ladder.choice.memory_bytes},
          {"points", std::move(rungs)},
          {"steps_down", ladder.steps_down},
          {"steps_up", ladder.steps_up},
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
                 {"quality", value_of(report.last_quality)}};
}

Figures fit_figures(const FitSummary& fit) {
  const recon::ResponseFit& shown = fit.misfits > 0 ? fit.worst : fit.last;
  return {{"frames", fit.frames},
          {"misfits", fit.misfits},
          {"residual_over_noise", shown.residual},
          {"least_over_noise", shown.least}};
}

Value left_out_figures(const std::optional<recon::ChannelDetector>& channels) {
  if (!channels) return {};
  Value::List ommatidia;
  const auto masked = channels->masked();
  for (std::size_t m = 0; m < masked.size(); ++m) {
    if (masked[m] != 0) ommatidia.emplace_back(m);
  }
  return Figures{{"ommatidia", std::move(ommatidia)},
                 {"found", channels->found()},
                 {"recovered", channels->recovered()},
                 {"crowded_frames", channels->crowded()}};
}

Figures stage_figures(const StageAccounts& accounts) {
  return {{"source", figures_of(accounts.source)},
          {"acquire", figures_of(accounts.acquire)},
          {"correct", figures_of(accounts.correct)},
          {"reconstruct", figures_of(accounts.reconstruct)},
          {"publish", figures_of(accounts.publish)}};
}

std::string_view lambda_sentence(LambdaOrigin origin) {
  switch (origin) {
    case LambdaOrigin::hand:
      return " as given";
    case LambdaOrigin::rule:
      return " by rule from sigma {operating_point.sigma:3}";
    case LambdaOrigin::samples:
      return " from the samples, {operating_point.lambda_over_rule:3} times the rule's";
    case LambdaOrigin::recording:
      return " as recorded, {operating_point.lambda_over_rule:3} times the rule's";
  }
  return {};
}

void tell_eye(Figures& f, const ReadyEye& eye) {
  f.tell(
      "{eye.board} ({eye.source}): {eye.ommatidia} ommatidia, {eye.blind_ommatidia} blind"
      "[, {eye.dead_ommatidia} dead][, {eye.masked_ommatidia} masked]; {eye.image_rows} x {eye.image_columns} pixels; "
      "scene {scene} at "
      "{distance_mm} mm, seed {seed}\n");
  if (eye.measured() != nullptr) f.tell("measured: ").tell(measured_sentence).tell("\n");
  f.tell(
      "{operating_point.solver}, {operating_point.basis}, {operating_point.iterations} iterations, lambda "
      "{operating_point.lambda:3}");
  f.tell(std::string(lambda_sentence(eye.lambda().origin)));
  f.tell(
      ", rho {operating_point.rho:3}\n"
      "set up in {setup_s:duration}, factor {factor}; memory: workspace {memory.workspace_bytes:bytes}, tables "
      "{memory.table_bytes:bytes}, set-up {memory.setup_peak_bytes:bytes} at its peak\n");
}

/// "stepped down 2 times and up once; frames of ..."
std::string steps_text(const LadderRun& ladder) {
  std::string text =
      fmt::format("stepped down {} and up {}; frames of", times(ladder.steps_down), times(ladder.steps_up));
  for (std::size_t r = 0; r < ladder.frames.size(); ++r) {
    text += fmt::format("{} {}: {}", r > 0 ? "," : "", point_text(ladder.points.points[ladder.choice.ladder[r]]),
                        ladder.frames[r]);
  }
  return text;
}

void tell_frames(Figures& f, const RunReport& report) {
  f.tell(
      "frames: {frames.produced} produced = {frames.delivered} delivered + {frames.dropped:sum} dropped"
      "[ ({frames.dropped})][, {frames.estimated} of them by estimate][ + {frames.checked} of checks]; {pacing}; "
      "ended: {ending} after "
      "{wall_s:duration}[, {recovering_s:duration} of it without frames, to get the eye back]\n");
  if (report.deadline) f.say(report.deadline->sentence() + "\n");
  if (report.ladder) f.say(report.ladder->sentence() + "\n" + steps_text(*report.ladder) + "\n");
  if (report.deadline || report.ladder) f.tell("deadline misses: {deadline.misses} of {frames.delivered}\n");
  f.tell(
      "health: {health.converged} converged, {health.budget_used} used their budget"
      "[, {health.saturated_frames} with saturated channels][, {health.overrun_flags} with overrun flags]"
      "[, {health.dark_frames} dark][, {health.untrusted_times} with an untrusted time]"
      "[, {health.config_mismatches} with another configuration][, {health.read_timeouts} reads timed out]"
      "[; {health.masked_channels_min} to {health.masked_channels_max} channels masked]\n");
  if (report.interruptions > 0) {
    f.tell(
        "picture: held or taken away {picture.interruptions} times, {picture.longest_gap_s:duration} at the longest\n");
  }
  if (report.channels && report.channels->found() > 0) {
    f.tell(
        "left out as dead, stuck or hot: {left_out.ommatidia:count} ommatidia[ ({left_out.ommatidia})]"
        "[, {left_out.recovered} times one recovered]\n");
  }
  if (report.fit.misfits > 0) {
    f.tell(
        "misfit: residual {fit.residual_over_noise:3} times what noise explains, and no picture's is below "
        "{fit.least_over_noise:3}, in {fit.misfits} of {fit.frames} frames looked at: do board, distance or "
        "calibration fit?\n");
  }
  if (report.checks) {
    f.tell(
        "checks: {checks.looks}[, {checks.could_not_look} of which could not look][, {checks.changes:# change} told]; "
        "the last says: {checks.verdict}\n");
  }
  if (!report.files.empty()) f.say("written: " + fmt::format("{}", fmt::join(report.files, ", ")) + "\n");
  const std::string counters = hal::text_of(report.summary.source_counters);
  if (!counters.empty()) f.say("source: " + counters).tell("[; {faults:# fault} in all]\n");
}

void tell_tables(Figures& f, const RunReport& report) {
  const Value::List stages{Figures{{"stage", "solve"}, {"ms", *f.find("solve_ms")}},
                           Figures{{"stage", "age"}, {"ms", *f.find("age_ms")}}};
  f.say("\n" +
        table_of(stages, {{"ms a frame", "{stage}", Align::left},
                          {"median", "{ms.median:3|n/a}"},
                          {"p90", "{ms.p90:3|n/a}"},
                          {"p99", "{ms.p99:3|n/a}"},
                          {"max", "{ms.max:3|n/a}"}}) +
        "\n");
  if (!report.quality) return;
  Value::List eyes{
      Figures{{"eye", fmt::format("reconstruction, mean of {}", report.measured)}, {"is", value_of(report.quality)}}};
  if (report.conventional) {
    eyes.push_back(Figures{{"eye", "conventional eye, one frame"}, {"is", value_of(report.conventional)}});
  }
  f.say(table_of(eyes, {{"against the scene", "{eye}", Align::left},
                        {"NMSE", "{is.nmse:3}"},
                        {"PSNR dB", "{is.psnr_db:.1}"},
                        {"SSIM", "{is.ssim:.3}"}}));
}

/// Of a table whose rows are printed by different processes: widths are agreed, not measured.
struct FixedColumn {
  std::string_view title;
  int width;  // negative: left
  std::string_view cell;
};
constexpr std::array<FixedColumn, 12> columns{{{"eye", -12, "{eye.board}"},
                                               {"scene", -10, "{scene}"},
                                               {"NMSE", 8, "{quality.nmse:3}"},
                                               {"PSNR dB", 8, "{quality.psnr_db:.1}"},
                                               {"SSIM", 6, "{quality.ssim:.3}"},
                                               {"conv NMSE", 10, "{conventional.nmse:3}"},
                                               {"conv PSNR", 10, "{conventional.psnr_db:.1}"},
                                               {"conv SSIM", 10, "{conventional.ssim:.3}"},
                                               {"ms a frame", 11, "{solve_ms.median:3|n/a}"},
                                               {"produced", 9, "{frames.produced}"},
                                               {"delivered", 10, "{frames.delivered}"},
                                               {"dropped", 8, "{frames.dropped:sum}"}}};

std::string padded(const FixedColumn& column, std::string_view cell) {
  return column.width < 0 ? fmt::format("{:<{}} ", cell, -column.width) : fmt::format("{:>{}}", cell, column.width);
}

}  // namespace

std::string LadderRun::sentence() const {
  const std::string text = firmware::sentence(choice, points);
  return points.cut_short.empty() ? text : text + "; the stored points are partial: " + points.cut_short;
}

std::string table_header() {
  std::string titles;
  for (const FixedColumn& column : columns) titles += padded(column, column.title);
  return titles + "\n" + std::string(titles.size(), '-') + "\n";
}

std::string table_row(const Figures& run) {
  std::string row;
  for (const FixedColumn& column : columns) row += padded(column, run.sentence(column.cell));
  return row + "\n";
}

Figures figures_of(const RunReport& report, const Board& board, const ReadyEye& eye) {
  const RunSummary& s = report.summary;
  Figures f{{"eye", eye_figures(board, eye, report.source)},
            {"scene", report.scene},
            {"seed", report.seed},
            {"distance_mm", board.object.distance_mm},
            {"pacing", report.lossless ? "lossless" : "live"},
            {"measured", value_of(eye.measured())},
            {"operating_point", point_figures(eye)},
            {"factor", name(eye.factor_origin())},
            {"memory", Figures{{"workspace_bytes", eye.reconstructor().required_bytes()},
                               {"table_bytes", eye.reconstructor().table_bytes()},
                               {"setup_peak_bytes", report.setup_peak_bytes}}},
            {"setup_s", report.setup_s},
            {"ending", name(s.ending)},
            {"frames", figures_of(s.frames)},
            {"stages", stage_figures(s.stages)},
            {"wall_s", ms(s.wall_ns) / 1e3},
            {"recovering_s", ms(s.recovering_ns) / 1e3},
            {"solve_ms", times_figures(s.solve)},
            {"age_ms", times_figures(s.age)},
            {"correct_ms", times_figures(s.correct)},
            {"write_ms", times_figures(s.write)},
            {"deadline", deadline_figures(report)},
            {"health", health_figures(s)},
            {"picture", report.picture},
            {"source_counters", counter_figures(s.source_counters)},
            {"faults", hal::faults_in(s.source_counters)},
            {"quality", value_of(report.quality)},
            {"quality_frames", report.measured},
            {"conventional", value_of(report.conventional)},
            {"last", last_figures(report)},
            {"fit", fit_figures(report.fit)},
            {"left_out", left_out_figures(report.channels)},
            {"checks", report.checks},
            {"files", report.files},
            {"notes", report.notes}};
  if (s.error) f.add("error", figures_of(*s.error));
  tell_eye(f, eye);
  tell_frames(f, report);
  tell_tables(f, report);
  return f;
}

}  // namespace compueye::firmware
