#include "firmware/app/commands/reconstruct_report.hpp"

#include <algorithm>
#include <iterator>
#include <string>
#include <vector>

#include "firmware/operating_points/measured_points.hpp"
#include "recon/option_names.hpp"
#include "recon/setup/solver_row.hpp"

namespace compueye::firmware {
namespace {

template <class Pick>
double median(std::span<const FrameRecord> frames, Pick pick) {
  std::vector<double> values;
  for (const FrameRecord& record : frames) values.push_back(pick(record));
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

double median(std::span<const FrameRecord> frames, double recon::FrameInfo::*figure) {
  return median(frames, [figure](const FrameRecord& r) { return r.info.*figure; });
}

std::int64_t count(std::span<const FrameRecord> frames, recon::Health health) {
  return std::count_if(frames.begin(), frames.end(), [&](const FrameRecord& r) { return r.info.health == health; });
}

/// Where lambda is from, a word and a sentence with what it is.
struct LambdaOrigin {
  std::string word, sentence;
};
LambdaOrigin lambda_origin(const ReconstructOptions& o) {
  if (!o.settings.has("--sigma")) return {"hand", "{objective.lambda:4} by hand"};
  if (!o.lambda_from_samples) return {"rule", "{objective.lambda:4} by rule from sigma {objective.sigma:4}"};
  return {"risk", "{objective.lambda:4} by risk of the first frame, sigma {objective.sigma:4}"};
}

/// What says how far a solver may stay from y, and its value.
void add_distance(const ReconstructOptions& o, const recon::Reconstructor& r, Figures& f) {
  const std::string lambda = lambda_origin(o).sentence;
  if (r.objective().epsilon) {
    f.line("epsilon", "{objective.epsilon:4}");
  } else if (r.plan().solver->rank == recon::RankUse::singular_values) {
    f.line("rank", o.settings.has("--rank") ? "{rank:,} by hand" : "{rank:,} singular values: s^2 >= " + lambda);
  } else {
    f.line("lambda", lambda);
  }
}

Figures point_figures(const recon::OperatingPoint& point) {
  return {{"operator", name(point.op)},
          {"basis", name(point.basis)},
          {"solver", name(point.solver)},
          {"precision", name(point.precision)},
          {"iterations", point.iterations}};
}

Figures objective_figures(const ReconstructOptions& o, std::optional<double> sigma, const recon::Objective& objective) {
  const bool box = objective.constraint == recon::ConstraintKind::box;
  return {{"constraint", name(objective.constraint)},
          {"lo", box ? Value(objective.lo) : Value()},
          {"hi", box ? Value(objective.hi) : Value()},
          {"lambda", objective.lambda},
          {"epsilon", objective.epsilon},
          {"huber", objective.huber},
          {"lambda_by", lambda_origin(o).word},
          {"sigma", sigma}};
}

Figures frame_figures(const FrameRecord& record) {
  const recon::FrameInfo& info = record.info;
  Figures frame{{"solve_ms", record.solve_ms},
                {"health", name(info.health)},
                {"iterations", info.iterations},
                {"channels_used", info.channels_used},
                {"warm", info.warm},
                {"channels_reweighted", info.channels_reweighted},
                {"objective", info.objective},
                {"duality_gap", info.duality_gap >= 0.0 ? Value(info.duality_gap) : Value()},
                {"residual", info.residual},
                {"residual_over_noise", record.fit ? Value(record.fit->residual) : Value()},
                {"least_over_noise", record.fit ? Value(record.fit->least) : Value()},
                {"primal_residual", info.primal_residual},
                {"dual_residual", info.dual_residual}};
  if (const auto& q = record.quality) frame.add("nmse", q->nmse).add("psnr_db", q->psnr_db).add("ssim", q->ssim);
  return frame;
}

/// The mean over all frames where there is a truth.
void add_quality(std::span<const FrameRecord> frames, Figures& f) {
  std::vector<PictureQuality> pictures;
  for (const FrameRecord& record : frames) {
    if (record.quality) pictures.push_back(*record.quality);
  }
  f.add("quality", pictures.empty() ? Value() : value_of(summarise(pictures).mean));
  if (pictures.empty()) return;
  const std::string note = frames.size() > 1 ? " (mean)" : "";
  f.line("NMSE", "{quality.nmse:4}" + note).line("PSNR", "{quality.psnr_db:.2} dB" + note);
  f.line("SSIM", "{quality.ssim:.4}" + note);
}

void add_written(const ReconstructOptions& o, std::span<const FrameRecord> frames, Figures& f) {
  const auto name_or_none = [](const std::string& file) { return file.empty() ? Value() : Value(file); };
  std::int64_t clipped = 0;
  for (const FrameRecord& record : frames) clipped += record.clipped_pixels;
  f.add("written", Figures{{"npy", name_or_none(o.out)}, {"png", name_or_none(o.png)}, {"clipped_pixels", clipped}});
  if (!o.out.empty()) f.line("written", "{written.npy}");
  if (o.png.empty()) return;
  f.line("written",
         std::string("{written.png}") + (frames.size() > 1 ? ", numbered by frame" : "") +
             (clipped > 0 ? "; {written.clipped_pixels:,} pixels beyond 0..1 clipped (--out keeps them)" : ""));
}

void add_problem(const ReconstructOptions& o, std::optional<double> sigma, const recon::Reconstructor& r, Figures& f) {
  const bool factor = recon::uses_factor(r.operating_point().solver);
  const bool box = r.objective().constraint == recon::ConstraintKind::box;
  f.add("response", o.response_file()).add("samples", o.samples);
  f.add("weights", o.weights.empty() ? Value() : Value(o.weights));
  f.add("operating_point", point_figures(r.operating_point()), "operating point",
        "{operating_point.solver}, {operating_point.basis} basis, A as {operating_point.operator}, "
        "{operating_point.precision}, {operating_point.iterations} iterations");
  f.add("objective", objective_figures(o, sigma, r.objective()), "constraint",
        box ? "box [[{objective.lo}, {objective.hi}]]" : "{objective.constraint}");
  f.add("rho", factor ? Value(r.plan().rho) : Value()).add("rank", r.plan().rank > 0 ? Value(r.plan().rank) : Value());
  add_distance(o, r, f);
  if (factor) f.line("rho", "{rho:4}");
  f.add("relaxation", r.plan().relaxation).add("max_reweighted", r.plan().max_reweighted);
  f.add("rows", r.image_rows()).add("cols", r.image_cols()).add("channels", r.channels());
  f.add("seeing_channels", r.seeing_channels(), "picture",
        "{rows}x{cols} pixels from {seeing_channels:,} seeing channels of {channels:,}");
}

void add_gap(std::span<const FrameRecord> frames, Figures& f) {
  if (frames.front().info.duality_gap < 0.0) {
    f.add("median_duality_gap", Value(), "duality gap", "none: this solver or problem has no dual to bound it by");
    return;
  }
  f.add("median_duality_gap", median(frames, &recon::FrameInfo::duality_gap), "duality gap",
        std::string(frames.size() > 1 ? "{:3} (median)" : "{:3}") +
            ", the most that the objective may lie above its optimum");
}

/// Of the frame that the response fits least.
void add_fit(std::span<const FrameRecord> frames, Figures& f) {
  const auto misfits =
      std::count_if(frames.begin(), frames.end(), [](const FrameRecord& r) { return r.fit && r.fit->misfit(); });
  const auto worst = std::max_element(frames.begin(), frames.end(), [](const FrameRecord& a, const FrameRecord& b) {
    return a.fit && b.fit && a.fit->least < b.fit->least;
  });
  const std::optional<recon::ResponseFit>& fit = worst->fit;
  f.add("fit",
        fit ? Value(Figures{
                  {"misfits", misfits}, {"residual_over_noise", fit->residual}, {"least_over_noise", fit->least}})
            : Value());
  if (misfits == 0) return;
  f.line("misfit",
         "residual {fit.residual_over_noise:3} times what noise explains, and no picture's is below "
         "{fit.least_over_noise:3}" +
             std::string(frames.size() > 1 ? ", in {fit.misfits:# frame}" : "") +
             ": do response, distance and samples belong together?");
}

bool is_invalid(const FrameRecord& record) {
  return record.info.health == recon::Health::invalid;
}

std::vector<FrameRecord> without_invalid(std::span<const FrameRecord> frames) {
  std::vector<FrameRecord> solved;
  std::copy_if(frames.begin(), frames.end(), std::back_inserter(solved),
               [](const FrameRecord& record) { return !is_invalid(record); });
  return solved;
}

/// A file keeps the numbers of its frames, so what could not be solved is black in it.
void add_passed_over(std::span<const FrameRecord> frames, Figures& f) {
  const auto first = std::find_if(frames.begin(), frames.end(), is_invalid);
  f.add("first_invalid", first == frames.end() ? Value() : Value(first - frames.begin()));
  if (first == frames.end()) return;
  f.line("passed over",
         "{health.invalid:# frame}, the first is {first_invalid:,} (counted from 0): a sample is no number, or numbers "
         "left the range of the solver; black in the files");
}

}  // namespace

Figures figures_of(const ReconstructOptions& o, const MeasuredEye* measured, std::optional<double> sigma,
                   const recon::Reconstructor& r, double setup_s, std::span<const FrameRecord> frames) {
  const std::vector<FrameRecord> solved = without_invalid(frames);
  const std::string of_frames = solved.size() > 1 ? " (median)" : "";
  Figures f;
  add_problem(o, sigma, r, f);
  f.add("measured", value_of(measured));
  if (measured != nullptr) f.line("measured", measured_sentence);
  f.add("frames", frames.size(), "frames", "{:,}");
  f.add("setup_s", setup_s, "set-up", "{:duration}");
  f.add("median_frame_ms", median(solved, [](const FrameRecord& each) { return each.solve_ms; }), "time a frame",
        "{:3} ms (median, duality gap included)");
  f.add("table_bytes", r.table_bytes()).add("workspace_bytes", r.required_bytes());
  f.line("memory", "{table_bytes:bytes} tables, {workspace_bytes:bytes} workspace");
  f.add("median_objective", median(solved, &recon::FrameInfo::objective), "objective", "{:6}" + of_frames);
  add_gap(solved, f);
  f.add("median_residual", median(solved, &recon::FrameInfo::residual), "residual", "{:4}" + of_frames);
  add_fit(solved, f);
  f.add("health",
        Figures{{"converged", count(frames, recon::Health::converged)},
                {"budget_used", count(frames, recon::Health::budget_used)},
                {"invalid", count(frames, recon::Health::invalid)}},
        "health", "{health.converged} converged, {health.budget_used} used all their iterations, as planned");
  add_passed_over(frames, f);
  add_quality(frames, f);
  add_written(o, frames, f);
  std::vector<Figures> per_frame;
  for (const FrameRecord& record : frames) per_frame.push_back(frame_figures(record));
  return f.add("per_frame", per_frame);
}

}  // namespace compueye::firmware
