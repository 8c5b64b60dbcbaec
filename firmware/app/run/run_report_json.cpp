#include <string>

#include "firmware/app/run/run_report.hpp"
#include "recon/option_names.hpp"

namespace compueye::firmware {
namespace {

double ms(std::int64_t ns) {
  return static_cast<double>(ns) / 1e6;
}

Json times_json(const TimeStatistics& times) {
  return {{"count", times.count},    {"min", ms(times.min_ns)}, {"median", ms(times.median_ns)},
          {"p90", ms(times.p90_ns)}, {"p99", ms(times.p99_ns)}, {"max", ms(times.max_ns)}};
}

Json quality_json(const std::optional<PictureQuality>& quality) {
  if (!quality) return nullptr;
  return {{"nmse", quality->nmse}, {"psnr_db", quality->psnr_db}, {"ssim", quality->ssim}};
}

Json eye_json(const EyeFigures& eye) {
  return {{"board", eye.board},
          {"source", eye.source},
          {"ommatidia", eye.ommatidia},
          {"blind_ommatidia", eye.blind},
          {"dead_ommatidia", eye.dead},
          {"image_rows", eye.image_rows},
          {"image_columns", eye.image_cols},
          {"frame_rate_hz", eye.frame_rate_hz}};
}

Json operating_point(const EyeFigures& eye) {
  return {{"solver", name(eye.point.solver)},
          {"basis", name(eye.point.basis)},
          {"operator", name(eye.point.op)},
          {"precision", eye.point.precision == recon::Precision::f32 ? "f32" : "f64"},
          {"iterations", eye.point.iterations},
          {"lambda", eye.lambda.value},
          {"lambda_by_rule", eye.lambda.by_rule},
          {"sigma", eye.lambda.by_rule ? Json(eye.lambda.sigma) : Json(nullptr)},
          {"rho", eye.rho}};
}

Json deadline_json(const RunReport& report) {
  const std::uint64_t misses = report.summary.deadline_misses;
  if (report.ladder) return ladder_json(*report.ladder, misses);
  const std::optional<DeadlineChoice>& choice = report.deadline;
  if (!choice) return nullptr;
  return {{"deadline_ms", choice->deadline_ms},
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

Json health(const RunSummary& s) {
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

Json counters_json(const std::vector<hal::Counter>& counters) {
  Json json = Json::object();
  for (const hal::Counter& each : counters) json[std::string(each.name)] = each.count;
  return json;
}

Json last_frame(const RunReport& report) {
  const RunSummary& s = report.summary;
  if (!s.last) return nullptr;
  return {{"frame", s.last_frame},
          {"objective", s.last->objective},
          {"residual", s.last->residual},
          {"primal_residual", s.last->primal_residual},
          {"dual_residual", s.last->dual_residual},
          {"channels_used", s.last->channels_used},
          {"channels_reweighted", s.last->channels_reweighted},
          {"quality", quality_json(report.last_quality)}};
}

Json stages(const StageAccounts& accounts) {
  return {{"source", json_of(accounts.source)},
          {"acquire", json_of(accounts.acquire)},
          {"correct", json_of(accounts.correct)},
          {"reconstruct", json_of(accounts.reconstruct)},
          {"publish", json_of(accounts.publish)}};
}

}  // namespace

Json report_json(const RunReport& report) {
  const RunSummary& s = report.summary;
  Json json{{"eye", eye_json(report.eye)},
            {"scene", report.scene},
            {"seed", report.seed},
            {"distance_mm", report.distance_mm},
            {"pacing", report.lossless ? "lossless" : "live"},
            {"operating_point", operating_point(report.eye)},
            {"factor", name(report.eye.factor)},
            {"memory", {{"workspace_bytes", report.eye.workspace_bytes}, {"table_bytes", report.eye.table_bytes}}},
            {"setup_s", report.setup_s},
            {"ending", name(s.ending)},
            {"frames", json_of(s.frames)},
            {"stages", stages(s.stages)},
            {"wall_s", ms(s.wall_ns) / 1e3},
            {"solve_ms", times_json(s.solve)},
            {"age_ms", times_json(s.age)},
            {"correct_ms", times_json(s.correct)},
            {"write_ms", times_json(s.write)},
            {"deadline", deadline_json(report)},
            {"health", health(s)},
            {"source_counters", counters_json(s.source_counters)},
            {"quality", quality_json(report.quality)},
            {"quality_frames", report.measured},
            {"conventional", quality_json(report.conventional)},
            {"last", last_frame(report)},
            {"files", report.files},
            {"notes", report.notes}};
  if (s.error) json.update(json_of(*s.error));
  return json;
}

}  // namespace compueye::firmware
