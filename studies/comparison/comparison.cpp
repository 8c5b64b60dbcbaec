#include "studies/comparison/comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "firmware/eye/ready_eye.hpp"
#include "firmware/eye/reconstructor_maker.hpp"
#include "firmware/pipeline/reconstructor_solver.hpp"
#include "hal/try.hpp"
#include "recon/option_names.hpp"
#include "recon/setup/mirror_symmetry.hpp"
#include "recon/setup/penalty_rule.hpp"
#include "recon/solver_list.hpp"
#include "studies/comparison/samples.hpp"
#include "studies/named_kinds.hpp"

namespace compueye::firmware {
namespace {

using hal::Result;

constexpr int more_without_factor = 10;        // times the board's iterations
constexpr int most_for_whole_spectrum = 2000;  // rows of a parity class, whose decomposition takes a minute
constexpr std::size_t most_repeats = 15;
constexpr double most_timing_ms = 500.0;

/// Runs the contenders one after the other; factors go from one to the next and, for the next time, into the board's
/// cache.
class Runner {
 public:
  Runner(const Board& board, const CompareSamples& samples, const hal::Clock& clock, const recon::Progress& progress)
      : board_(board),
        samples_(samples),
        clock_(clock),
        progress_(progress),
        maker_(samples.living.response, board.plan.op, board.cache(), ReconstructorMaker::Memory::remembers),
        seeing_(static_cast<int>(maker_.response().seeing_rows().size())) {}

  Result<ComparedRow> run(const Contender& contender) {
    ComparedRow row;
    row.contender = contender;
    const std::int64_t began_ns = clock_.now_ns();
    row.lambda = TRY(lambda_of(contender));
    const recon::Objective objective{contender.basis, contender.constraint, board_.objective.lo, board_.objective.hi,
                                     row.lambda};
    const recon::Reconstructor solver = TRY(maker_.make(objective, plan_of(contender), progress_));
    row.setup_s = static_cast<double>(clock_.now_ns() - began_ns) * 1e-9;
    TRY(solve(solver, row));
    row.quality = TRY(quality_of(row.picture, samples_.truth));
    return row;
  }

  [[nodiscard]] const std::vector<std::string>& notes() const noexcept { return maker_.notes(); }

 private:
  [[nodiscard]] recon::Plan plan_of(const Contender& contender) const {
    recon::Plan plan = board_.plan;
    plan.solver = contender.solver;
    plan.warm_start = false;
    if (!recon::uses_factor(contender.solver) && !board_.overrules("reconstruction", "iterations")) {
      plan.iterations = std::min(more_without_factor * plan.iterations, 1'000'000);
    }
    // The board's rho was chosen for the board's metric, and is no step of pdhg.
    const bool penalised = contender.solver->rho == recon::RhoUse::penalty;
    if (!penalised || recon::metric_of(contender.basis) != recon::metric_of(board_.objective.basis)) plan.rho = 0.0;
    plan.max_reweighted = static_cast<int>(
        std::count_if(samples_.weights.begin(), samples_.weights.end(), [](float w) { return w != 1.0F; }));
    plan.max_reweighted = std::min(plan.max_reweighted, seeing_);
    plan.measure_gap = true;
    return plan;
  }

  /// By hand, else the board's for the board's own basis, else by rule.
  [[nodiscard]] Result<double> lambda_of(const Contender& contender) const {
    const bool boards = contender.basis == board_.objective.basis && contender.solver->minimises;
    const bool stated = boards || board_.overrules("reconstruction", "lambda");
    return TRY(choose_lambda(maker_.response(), contender.solver, contender.basis,
                             stated ? board_.lambda : std::nullopt, board_.noise_sigma()))
        .value;
  }

  Result<void> solve(const recon::Reconstructor& reconstructor, ComparedRow& row) {
    ReconstructorSolver solver(reconstructor);
    row.picture = hal::Image(reconstructor.image_rows(), reconstructor.image_cols());
    std::vector<double> times;
    double total_ms = 0.0;
    while (times.empty() || (times.size() < most_repeats && total_ms < most_timing_ms)) {
      const std::int64_t began_ns = clock_.now_ns();
      row.info = solver.solve(samples_.y, samples_.weights, row.picture.pixels);
      times.push_back(static_cast<double>(clock_.now_ns() - began_ns) * 1e-6);
      total_ms += times.back();
    }
    std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
    row.solve_ms = times[times.size() / 2];
    row.rank = reconstructor.plan().rank;
    row.workspace_bytes = reconstructor.required_bytes();
    row.table_bytes = reconstructor.table_bytes();
    if (row.info.health != recon::Health::invalid) return {};
    return hal::fail(hal::ErrorCode::out_of_range,
                     fmt::format("{} with {}", name(row.contender.solver), name(row.contender.basis)),
                     "could not solve the frame: its numbers left the range of float32");
  }

  const Board& board_;
  const CompareSamples& samples_;
  const hal::Clock& clock_;
  const recon::Progress& progress_;
  ReconstructorMaker maker_;
  int seeing_;
};

/// What keeps singular values decomposes A A' whole: for an eye that is large and not symmetric that takes many minutes
/// without a word.
bool takes_too_long(const Contender& contender, const CompareOptions& options, const recon::Response& response) {
  if (contender.solver->rank != recon::RankUse::singular_values || !options.solvers.empty()) return false;
  const auto rows = response.seeing_rows();
  if (static_cast<int>(rows.size()) <= most_for_whole_spectrum) return false;
  const auto images = recon::find_mirror_symmetry(response.select_rows(rows));
  return rows.size() / images.order() > most_for_whole_spectrum;
}

std::string title_of(const Contender& c) {
  return fmt::format("{} {} {}", name(c.basis), name(c.constraint), name(c.solver));
}

void fill_excess(std::vector<ComparedRow>& rows) {
  for (ComparedRow& row : rows) {
    if (!row.contender.solver->minimises) continue;
    double least = std::numeric_limits<double>::infinity();
    for (const ComparedRow& other : rows) {
      const bool same = other.contender.solver->minimises && other.contender.basis == row.contender.basis &&
                        other.contender.constraint == row.contender.constraint && other.lambda == row.lambda;
      if (same) least = std::min(least, other.info.objective);
    }
    row.excess = least > 0.0 ? row.info.objective / least - 1.0 : 0.0;
  }
}

/// What a comparison says before anything is solved.
Result<Comparison> head_of(const Board& board, const CompareOptions& options, CompareSamples& samples) {
  Comparison head;
  head.board = board.name;
  head.scene = samples.scene;
  head.exact = options.exact;
  head.sigma = board.noise_sigma();
  head.seed = options.seed;
  head.scene_seed = options.scene.seed;
  head.channels = samples.living.response.rows();
  head.seeing = static_cast<int>(samples.living.response.seeing_rows().size());
  head.measured = samples.living.measured;
  head.threads = board.plan.threads;
  if (samples.conventional) {
    head.conventional_quality = TRY(quality_of(*samples.conventional, samples.truth));
  } else {
    head.notes.emplace_back("the conventional eye is left out: this lattice has no interommatidial angle");
  }
  return head;
}

}  // namespace

Result<std::vector<Contender>> contenders(const CompareOptions& options, recon::ConstraintKind wanted) {
  const auto solvers = TRY(kinds_of("--solvers", options.solvers, recon::solver_names()));
  const auto bases = TRY(kinds_of("--bases", options.bases, recon::basis_names()));
  std::vector<Contender> all;
  for (const recon::BasisKind basis : bases) {
    for (const recon::SolverKind solver : solvers) {
      for (const recon::ConstraintKind constraint : {wanted, recon::ConstraintKind::none}) {
        if (!recon::supports(solver, basis, constraint)) continue;
        all.push_back({solver, basis, constraint});
        break;
      }
    }
  }
  if (!all.empty()) return all;
  return hal::fail(hal::ErrorCode::usage, "--solvers",
                   "and --bases leave nothing to compare; `compueye reconstruct --help` says what goes with what");
}

Result<Comparison> compare(const Board& board, const CompareOptions& options, const hal::Clock& clock,
                           const recon::Progress& progress) {
  const std::vector<Contender> all = TRY(contenders(options, board.objective.constraint));
  CompareSamples samples = TRY(take_samples(board, options, progress));
  Comparison comparison = TRY(head_of(board, options, samples));
  double done = 0.0;
  // One stage from the first solver to the last, so that its remaining time means something.
  const recon::Progress overall = {
      [&](std::string_view, double, double) { return progress("comparing", done, static_cast<double>(all.size())); },
      [&](std::string_view what, double seconds) { progress.expect(what, seconds); }};
  Runner runner(board, samples, clock, overall);
  std::optional<hal::Error> first_failure;
  for (const Contender& contender : all) {
    if (takes_too_long(contender, options, samples.living.response)) {
      comparison.notes.emplace_back(
          "tsvd is left out: the whole spectrum of this eye takes many minutes; --solvers "
          "tsvd asks for it");
      continue;
    }
    ++comparison.planned;
    if (!overall("comparing", 0.0, 0.0)) {
      comparison.missing.push_back(title_of(contender));
      continue;
    }
    auto row = runner.run(contender);
    done += 1.0;
    if (row) {
      comparison.rows.push_back(std::move(*row));
      continue;
    }
    comparison.missing.push_back(title_of(contender));
    if (row.error().code == hal::ErrorCode::interrupted) continue;
    comparison.notes.push_back(title_of(contender) + " is left out: " + row.error().text());
    if (!first_failure) first_failure = std::move(row.error());
  }
  static_cast<void>(overall("comparing", 0.0, 0.0));
  if (comparison.rows.empty() && first_failure) return tl::unexpected(std::move(*first_failure));
  if (comparison.rows.empty() && comparison.planned > 0) {
    return hal::fail(hal::ErrorCode::interrupted, board.name, "stopped before the first solver was done");
  }
  fill_excess(comparison.rows);
  comparison.notes.insert(comparison.notes.end(), runner.notes().begin(), runner.notes().end());
  comparison.truth = std::move(samples.truth);
  comparison.conventional = std::move(samples.conventional);
  return comparison;
}

const ComparedRow* best_of(const Comparison& comparison) {
  const auto less = [](const ComparedRow& a, const ComparedRow& b) { return a.quality.nmse < b.quality.nmse; };
  const auto best = std::min_element(comparison.rows.begin(), comparison.rows.end(), less);
  return best == comparison.rows.end() ? nullptr : &*best;
}

Figures figures_of(const ComparedRow& row) {
  const bool has_gap = row.info.duality_gap >= 0.0;
  return {{"basis", name(row.contender.basis)},
          {"constraint", name(row.contender.constraint)},
          {"solver", name(row.contender.solver)},
          {"lambda", row.lambda},
          {"rank", row.rank > 0 ? Value(row.rank) : Value()},
          {"nmse", row.quality.nmse},
          {"psnr_db", row.quality.psnr_db},
          {"ssim", row.quality.ssim},
          {"objective", row.info.objective},
          {"excess", row.excess},
          {"duality_gap", has_gap ? Value(row.info.duality_gap) : Value()},
          {"residual", row.info.residual},
          {"iterations", row.info.iterations},
          {"health", name(row.info.health)},
          {"solve_ms", row.solve_ms},
          {"setup_s", row.setup_s},
          {"workspace_bytes", row.workspace_bytes},
          {"table_bytes", row.table_bytes}};
}

}  // namespace compueye::firmware
