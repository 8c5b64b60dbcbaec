#include "firmware/app/commands/reconstruct_report.hpp"

#include <algorithm>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

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

/// What lambda is, and where it is from.
std::string lambda_sentence(const ReconstructReport& r) {
  if (!r.options.sigma) return "{objective.lambda:4} by hand";
  return r.options.lambda_from_samples ? "{objective.lambda:4} by risk of the first frame, sigma {objective.sigma:4}"
                                       : "{objective.lambda:4} by rule from sigma {objective.sigma:4}";
}

std::string lambda_origin(const ReconstructReport& r) {
  if (!r.options.sigma) return "hand";
  return r.options.lambda_from_samples ? "risk" : "rule";
}

/// What says how far a solver may stay from y, and its value.
void add_distance(const ReconstructReport& r, Figures& f) {
  if (r.options.epsilon) {
    f.line("epsilon", "{objective.epsilon:4}");
  } else if (r.point.solver->rank == recon::RankUse::singular_values) {
    f.line("rank", r.options.rank ? "{rank:,} by hand" : "{rank:,} singular values: s^2 >= " + lambda_sentence(r));
  } else {
    f.line("lambda", lambda_sentence(r));
  }
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
void add_quality(const ReconstructReport& r, Figures& f) {
  if (!rated(r)) {
    f.add("quality", Value());
    return;
  }
  const std::string note = r.frames > 1 ? " (mean)" : "";
  f.add("quality", Figures{{"nmse", mean(r, nmse_of)}, {"psnr_db", mean(r, psnr_of)}, {"ssim", mean(r, ssim_of)}});
  f.line("NMSE", "{quality.nmse:4}" + note).line("PSNR", "{quality.psnr_db:.2} dB" + note);
  f.line("SSIM", "{quality.ssim:.4}" + note);
}

void add_written(const ReconstructReport& r, Figures& f) {
  const auto name_or_none = [](const std::string& file) { return file.empty() ? Value() : Value(file); };
  f.add("written", Figures{{"npy", name_or_none(r.options.out)}, {"png", name_or_none(r.options.png)}});
  if (!r.options.out.empty()) f.line("written", "{written.npy}");
  if (!r.options.png.empty()) f.line("written", r.frames > 1 ? "{written.png}, numbered by frame" : "{written.png}");
}

void add_problem(const ReconstructReport& r, Figures& f) {
  const bool factor = recon::uses_factor(r.point.solver);
  const bool box = r.objective.constraint == recon::ConstraintKind::box;
  f.add("response", r.options.response).add("samples", r.options.samples);
  f.add("weights", r.options.weights.empty() ? Value() : Value(r.options.weights));
  f.add("operating_point", point_figures(r.point), "operating point",
        "{operating_point.solver}, {operating_point.basis} basis, A as {operating_point.operator}, "
        "{operating_point.precision}, {operating_point.iterations} iterations");
  f.add("objective", objective_figures(r), "constraint",
        box ? "box [[{objective.lo}, {objective.hi}]]" : "{objective.constraint}");
  f.add("rho", factor ? Value(r.plan.rho) : Value()).add("rank", r.plan.rank > 0 ? Value(r.plan.rank) : Value());
  add_distance(r, f);
  if (factor) f.line("rho", "{rho:4}");
  f.add("relaxation", r.plan.relaxation).add("max_reweighted", r.plan.max_reweighted);
  f.add("rows", r.size.rows).add("cols", r.size.cols).add("channels", r.channels);
  f.add("seeing_channels", r.seeing_channels, "picture",
        "{rows}x{cols} pixels from {seeing_channels:,} seeing channels of {channels:,}");
}

void add_gap(const ReconstructReport& r, Figures& f) {
  if (r.records.front().info.duality_gap < 0.0) {
    f.add("median_duality_gap", Value(), "duality gap", "none: this solver or problem has no dual to bound it by");
    return;
  }
  f.add(
      "median_duality_gap", median(figures(r, gap_of)), "duality gap",
      std::string(r.frames > 1 ? "{:3} (median)" : "{:3}") + ", the most that the objective may lie above its optimum");
}

}  // namespace

Figures report_figures(const ReconstructReport& r) {
  const std::string of_frames = r.frames > 1 ? " (median)" : "";
  Figures f;
  add_problem(r, f);
  f.add("frames", r.frames, "frames", "{:,}");
  f.add("setup_s", r.setup_s, "set-up", "{:duration}");
  f.add("median_frame_ms", median(figures(r, solve_ms)), "time a frame", "{:3} ms (median, duality gap included)");
  f.add("table_bytes", r.table_bytes).add("workspace_bytes", r.workspace_bytes);
  f.line("memory", "{table_bytes:bytes} tables, {workspace_bytes:bytes} workspace");
  f.add("median_objective", median(figures(r, objective_of)), "objective", "{:6}" + of_frames);
  add_gap(r, f);
  f.add("median_residual", median(figures(r, residual_of)), "residual", "{:4}" + of_frames);
  f.add("health",
        Figures{{"converged", count(r, recon::Health::converged)},
                {"budget_used", count(r, recon::Health::budget_used)},
                {"invalid", count(r, recon::Health::invalid)}},
        "health", "{health.converged} converged, {health.budget_used} used their budget (normal in real time)");
  add_quality(r, f);
  add_written(r, f);
  std::vector<Figures> frames;
  for (const FrameRecord& record : r.records) frames.push_back(frame_figures(record));
  return f.add("per_frame", frames);
}

}  // namespace compueye::firmware
