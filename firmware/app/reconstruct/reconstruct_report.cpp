#include "firmware/app/reconstruct/reconstruct_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <string_view>
#include <utility>

#include "firmware/text/number_text.hpp"
#include "firmware/text/table.hpp"
#include "recon/option_names.hpp"

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
  return r.point.solver == recon::SolverKind::tsvd ? "rank" : "lambda";
}

std::string distance_text(const ReconstructReport& r) {
  if (r.options.epsilon) return significant(*r.options.epsilon, 4);
  if (r.point.solver == recon::SolverKind::tsvd) {
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

Json outputs_json(const ReconstructReport& r) {
  Json out = Json::object();
  out["npy"] = r.options.out.empty() ? Json() : Json(r.options.out);
  out["png"] = r.options.png.empty() ? Json() : Json(r.options.png);
  return out;
}

Json point_json(const recon::OperatingPoint& point) {
  return {{"operator", name(point.op)},
          {"basis", name(point.basis)},
          {"solver", name(point.solver)},
          {"precision", name_of(point.precision)},
          {"iterations", point.iterations}};
}

Json objective_json(const ReconstructReport& r) {
  const bool box = r.objective.constraint == recon::ConstraintKind::box;
  return {{"constraint", name(r.objective.constraint)},
          {"lo", box ? Json(r.objective.lo) : Json()},
          {"hi", box ? Json(r.objective.hi) : Json()},
          {"lambda", r.objective.lambda},
          {"epsilon", r.options.epsilon ? Json(*r.options.epsilon) : Json()},
          {"lambda_by", lambda_origin(r)},
          {"sigma", r.options.sigma ? Json(*r.options.sigma) : Json()}};
}

Json frame_json(const FrameRecord& record) {
  const recon::FrameInfo& info = record.info;
  Json frame{{"solve_ms", record.solve_ms},
             {"health", name_of(info.health)},
             {"iterations", info.iterations},
             {"channels_used", info.channels_used},
             {"warm", info.warm},
             {"channels_reweighted", info.channels_reweighted},
             {"objective", info.objective},
             {"duality_gap", info.duality_gap >= 0.0 ? Json(info.duality_gap) : Json()},
             {"residual", info.residual},
             {"primal_residual", info.primal_residual},
             {"dual_residual", info.dual_residual}};
  if (record.quality) {
    frame["nmse"] = record.quality->nmse;
    frame["psnr_db"] = record.quality->psnr_db;
    frame["ssim"] = record.quality->ssim;
  }
  return frame;
}

}  // namespace

std::string report_text(const ReconstructReport& r) {
  Table table({{"figure", Align::left}, {"value", Align::left}});
  table.add({"operating point",
             fmt::format("{}, {} basis, A as {}, {}, {} iterations", name(r.point.solver), name(r.point.basis),
                         name(r.point.op), name_of(r.point.precision), r.point.iterations)});
  table.add({"constraint", constraint_text(r.objective)});
  table.add({distance_name(r), distance_text(r)});
  if (recon::uses_factor(r.point.solver)) table.add({"rho", significant(r.plan.rho, 4)});
  table.add({"picture", fmt::format("{}x{} pixels from {} seeing channels of {}", r.size.rows, r.size.cols,
                                    grouped(r.seeing_channels), grouped(r.channels))});
  table.add({"frames", grouped(r.frames)});
  table.add({"set-up", duration(r.setup_s)});
  table.add({"time a frame", significant(median(figures(r, solve_ms)), 3) + " ms (median, duality gap included)"});
  table.add({"memory", bytes(r.table_bytes) + " tables, " + bytes(r.workspace_bytes) + " workspace"});
  table.add({"objective", significant(median(figures(r, objective_of)), 6) + (r.frames > 1 ? " (median)" : "")});
  table.add({"duality gap", gap_text(r)});
  table.add({"residual", significant(median(figures(r, residual_of)), 4) + (r.frames > 1 ? " (median)" : "")});
  table.add({"health", health_text(r)});
  if (rated(r)) {
    const std::string note = r.frames > 1 ? " (mean)" : "";
    table.add({"NMSE", significant(mean(r, nmse_of), 4) + note});
    table.add({"PSNR", fixed(mean(r, psnr_of), 2) + " dB" + note});
    table.add({"SSIM", fixed(mean(r, ssim_of), 4) + note});
  }
  if (!r.options.out.empty()) table.add({"written", r.options.out});
  if (!r.options.png.empty()) table.add({"written", r.options.png + (r.frames > 1 ? ", numbered by frame" : "")});
  return table.text();
}

Json report_json(const ReconstructReport& r) {
  Json frames = Json::array();
  for (const FrameRecord& record : r.records) frames.push_back(frame_json(record));
  Json json{{"response", r.options.response},
            {"samples", r.options.samples},
            {"weights", r.options.weights.empty() ? Json() : Json(r.options.weights)},
            {"operating_point", point_json(r.point)},
            {"objective", objective_json(r)},
            {"rho", recon::uses_factor(r.point.solver) ? Json(r.plan.rho) : Json()},
            {"rank", r.plan.rank > 0 ? Json(r.plan.rank) : Json()},
            {"relaxation", r.plan.relaxation},
            {"max_reweighted", r.plan.max_reweighted},
            {"rows", r.size.rows},
            {"cols", r.size.cols},
            {"channels", r.channels},
            {"seeing_channels", r.seeing_channels},
            {"frames", r.frames},
            {"setup_s", r.setup_s},
            {"median_frame_ms", median(figures(r, solve_ms))},
            {"table_bytes", r.table_bytes},
            {"workspace_bytes", r.workspace_bytes},
            {"median_objective", median(figures(r, objective_of))},
            {"median_duality_gap", has_gap(r) ? Json(median(figures(r, gap_of))) : Json()},
            {"median_residual", median(figures(r, residual_of))},
            {"health",
             {{"converged", count(r, recon::Health::converged)},
              {"budget_used", count(r, recon::Health::budget_used)},
              {"invalid", count(r, recon::Health::invalid)}}}};
  json["quality"] = Json();
  if (rated(r)) {
    json["quality"] = {{"nmse", mean(r, nmse_of)}, {"psnr_db", mean(r, psnr_of)}, {"ssim", mean(r, ssim_of)}};
  }
  json["written"] = outputs_json(r);
  json["per_frame"] = std::move(frames);
  return json;
}

}  // namespace compueye::firmware
