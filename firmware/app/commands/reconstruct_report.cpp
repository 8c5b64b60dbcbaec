#include "firmware/app/commands/reconstruct_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "firmware/text/number_text.hpp"
#include "recon/option_names.hpp"
#include "recon/solver_list.hpp"

namespace compueye::firmware {
namespace {

std::string_view name_of(recon::Precision precision) {
  return precision == recon::Precision::f64 ? "f64" : "f32";
}
std::string_view name_of(recon::Health health) {
  switch (health) {
    case recon::Health::converged:
      return "converged";
    case recon::Health::budget_used:
      return "budget_used";
    case recon::Health::invalid:
      break;
  }
  return "invalid";
}

template <class Pick>
std::vector<double> figures(const ReconstructReport& report, Pick&& pick) {
  std::vector<double> values;
  for (const FrameRecord& record : report.records) values.push_back(pick(record));
  return values;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

template <class Pick>
double mean(const ReconstructReport& report, Pick&& pick) {
  const std::vector<double> values = figures(report, std::forward<Pick>(pick));
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

constexpr auto solve_ms = [](const FrameRecord& r) { return r.solve_ms; };
constexpr auto objective_of = [](const FrameRecord& r) { return r.info.objective; };
constexpr auto residual_of = [](const FrameRecord& r) { return r.info.residual; };
constexpr auto gap_of = [](const FrameRecord& r) { return r.info.duality_gap; };
constexpr auto nmse_of = [](const FrameRecord& r) { return r.quality ? r.quality->nmse : 0.0; };
constexpr auto psnr_of = [](const FrameRecord& r) { return r.quality ? r.quality->psnr_db : 0.0; };
constexpr auto ssim_of = [](const FrameRecord& r) { return r.quality ? r.quality->ssim : 0.0; };

std::int64_t count(const ReconstructReport& report, recon::Health health) {
  return std::count_if(report.records.begin(), report.records.end(),
                       [&](const FrameRecord& r) { return r.info.health == health; });
}

std::string constraint_text(const recon::Objective& objective) {
  if (objective.constraint != recon::ConstraintKind::box) return std::string(name(objective.constraint));
  return fmt::format("box [{}, {}]", objective.lo, objective.hi);
}

std::string lambda_text(const ReconstructReport& r) {
  const std::string value = significant(r.objective.lambda, 4);
  if (!r.options.sigma) return value + " by hand";
  return value + (r.options.lambda_from_samples ? " by risk of the first frame, sigma " : " by rule from sigma ") +
         significant(*r.options.sigma, 4);
}

std::string lambda_origin(const ReconstructReport& r) {
  if (!r.options.sigma) return "hand";
  return r.options.lambda_from_samples ? "risk" : "rule";
}

/// What says how far a solver may stay from y, and its value.
std::string distance_name(const ReconstructReport& r) {
  if (r.options.epsilon) return "epsilon";
  return r.point.solver->rank == recon::RankUse::singular_values ? "rank" : "lambda";
}

std::string distance_text(const ReconstructReport& r) {
  if (r.options.epsilon) return significant(*r.options.epsilon, 4);
  if (r.point.solver->rank == recon::RankUse::singular_values) {
    return grouped(r.plan.rank) + (r.options.rank ? " by hand" : " singular values: s^2 >= " + lambda_text(r));
  }
  return lambda_text(r);
}

bool has_gap(const ReconstructReport& r) {
  return r.records.front().info.duality_gap >= 0.0;
}

std::string gap_text(const ReconstructReport& r) {
  if (!has_gap(r)) return "none: this solver or problem has no dual to bound it by";
  return significant(median(figures(r, gap_of)), 3) + (r.frames > 1 ? " (median)" : "") +
         ", the most that the objective may lie above its optimum";
}

std::string health_text(const ReconstructReport& r) {
  return fmt::format("{} converged, {} used their budget (normal in real time)", count(r, recon::Health::converged),
                     count(r, recon::Health::budget_used));
}

bool rated(const ReconstructReport& r) {
  return r.records.front().quality.has_value();
}

Figures point_figures(const recon::OperatingPoint& point) {
  return {{"operator", name(point.op)},
          {"basis", name(point.basis)},
          {"solver", name(point.solver)},
          {"precision", name_of(point.precision)},
          {"iterations", point.iterations}};
}

Figures objective_figures(const ReconstructReport& r) {
  const bool box = r.objective.constraint == recon::ConstraintKind::box;
  return {{"constraint", name(r.objective.constraint)},
          {"lo", box ? Value(r.objective.lo) : Value()},
          {"hi", box ? Value(r.objective.hi) : Value()},
          {"lambda", r.objective.lambda},
          {"epsilon", r.options.epsilon},
          {"lambda_by", lambda_origin(r)},
          {"sigma", r.options.sigma}};
}

Figures frame_figures(const FrameRecord& record) {
  const recon::FrameInfo& info = record.info;
  Figures frame{{"solve_ms", record.solve_ms},
                {"health", name_of(info.health)},
                {"iterations", info.iterations},
                {"channels_used", info.channels_used},
                {"warm", info.warm},
                {"channels_reweighted", info.channels_reweighted},
                {"objective", info.objective},
                {"duality_gap", info.duality_gap >= 0.0 ? Value(info.duality_gap) : Value()},
                {"residual", info.residual},
                {"primal_residual", info.primal_residual},
                {"dual_residual", info.dual_residual}};
  if (const auto& q = record.quality) frame.add("nmse", q->nmse).add("psnr_db", q->psnr_db).add("ssim", q->ssim);
  return frame;
}

/// The mean over all frames where there is a truth.
Value quality_figures(const ReconstructReport& r, Figures& f) {
  if (!rated(r)) return {};
  const double nmse = mean(r, nmse_of), psnr_db = mean(r, psnr_of), ssim = mean(r, ssim_of);
  const std::string note = r.frames > 1 ? " (mean)" : "";
  f.line("NMSE", significant(nmse, 4) + note);
  f.line("PSNR", fixed(psnr_db, 2) + " dB" + note);
  f.line("SSIM", fixed(ssim, 4) + note);
  return Figures{{"nmse", nmse}, {"psnr_db", psnr_db}, {"ssim", ssim}};
}

Value written_figures(const ReconstructReport& r, Figures& f) {
  const auto name_or_none = [](const std::string& file) { return file.empty() ? Value() : Value(file); };
  if (!r.options.out.empty()) f.line("written", r.options.out);
  if (!r.options.png.empty()) f.line("written", r.options.png + (r.frames > 1 ? ", numbered by frame" : ""));
  return Figures{{"npy", name_or_none(r.options.out)}, {"png", name_or_none(r.options.png)}};
}

void add_problem(const ReconstructReport& r, Figures& f) {
  const bool factor = recon::uses_factor(r.point.solver);
  f.add("response", r.options.response).add("samples", r.options.samples);
  f.add("weights", r.options.weights.empty() ? Value() : Value(r.options.weights));
  f.add("operating_point", "operating point",
        fmt::format("{}, {} basis, A as {}, {}, {} iterations", name(r.point.solver), name(r.point.basis),
                    name(r.point.op), name_of(r.point.precision), r.point.iterations),
        point_figures(r.point));
  f.add("objective", "constraint", constraint_text(r.objective), objective_figures(r));
  f.line(distance_name(r), distance_text(r));
  f.add("rho", "rho", factor ? significant(r.plan.rho, 4) : "", factor ? Value(r.plan.rho) : Value());
  f.add("rank", r.plan.rank > 0 ? Value(r.plan.rank) : Value());
  f.add("relaxation", r.plan.relaxation).add("max_reweighted", r.plan.max_reweighted);
  f.add("rows", r.size.rows).add("cols", r.size.cols).add("channels", r.channels);
  f.add("seeing_channels", "picture",
        fmt::format("{}x{} pixels from {} seeing channels of {}", r.size.rows, r.size.cols, grouped(r.seeing_channels),
                    grouped(r.channels)),
        r.seeing_channels);
}

}  // namespace

Figures report_figures(const ReconstructReport& r) {
  const std::string of_frames = r.frames > 1 ? " (median)" : "";
  const double time = median(figures(r, solve_ms)), objective = median(figures(r, objective_of));
  const double residual = median(figures(r, residual_of));
  Figures f;
  add_problem(r, f);
  f.add("frames", "frames", grouped(r.frames), r.frames);
  f.add("setup_s", "set-up", duration(r.setup_s), r.setup_s);
  f.add("median_frame_ms", "time a frame", significant(time, 3) + " ms (median, duality gap included)", time);
  f.add("table_bytes", "memory", bytes(r.table_bytes) + " tables, " + bytes(r.workspace_bytes) + " workspace",
        r.table_bytes);
  f.add("workspace_bytes", r.workspace_bytes);
  f.add("median_objective", "objective", significant(objective, 6) + of_frames, objective);
  f.add("median_duality_gap", "duality gap", gap_text(r), has_gap(r) ? Value(median(figures(r, gap_of))) : Value());
  f.add("median_residual", "residual", significant(residual, 4) + of_frames, residual);
  f.add("health", "health", health_text(r),
        Figures{{"converged", count(r, recon::Health::converged)},
                {"budget_used", count(r, recon::Health::budget_used)},
                {"invalid", count(r, recon::Health::invalid)}});
  f.add("quality", quality_figures(r, f));
  f.add("written", written_figures(r, f));
  std::vector<Figures> frames;
  for (const FrameRecord& record : r.records) frames.push_back(frame_figures(record));
  return f.add("per_frame", frames);
}

}  // namespace compueye::firmware
