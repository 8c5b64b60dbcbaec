#include "studies/comparison/comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "firmware/eye/kept_factor.hpp"
#include "recon/core/parts/workspace.hpp"
#include "recon/lambda_rule.hpp"
#include "recon/option_names.hpp"
#include "recon/setup/mirror_symmetry.hpp"
#include "recon/setup/penalty_rule.hpp"
#include "recon/setup/quantised_response.hpp"

namespace compueye::firmware {
namespace {

using hal::Result;

constexpr int more_without_factor = 10;        // times the board's iterations
constexpr int most_for_whole_spectrum = 2000;  // rows of a parity class, whose decomposition takes a minute
constexpr std::size_t most_repeats = 15;
constexpr double most_timing_ms = 500.0;

bool shares_objective(recon::SolverKind solver) {
  return solver != recon::SolverKind::omp && solver != recon::SolverKind::tikhonov && solver != recon::SolverKind::tsvd;
}

/// Runs the contenders one after the other; factors go from one to the next and, for the next time, into the board's
/// cache.
class Runner {
 public:
  Runner(const Board& board, const CompareOptions& options, const CompareSamples& samples, const hal::Clock& clock,
         const recon::Progress& progress)
      : board_(board),
        options_(options),
        samples_(samples),
        clock_(clock),
        progress_(progress),
        op_(board.reconstruction.op),
        rounded_(op_ && recon::is_lossy(*op_) ? std::optional(recon::quantised(samples.response, *op_)) : std::nullopt),
        response_(rounded_ ? *rounded_ : samples.response),
        hash_(response_.content_hash()),
        seeing_(static_cast<int>(response_.seeing_rows().size())) {}

  Result<ComparedRow> run(const Contender& contender) {
    ComparedRow row;
    row.contender = contender;
    const std::int64_t began_ns = clock_.now_ns();
    auto made = set_up(contender, row);
    if (!made) return tl::unexpected(std::move(made.error()));
    row.setup_s = static_cast<double>(clock_.now_ns() - began_ns) * 1e-9;
    if (auto solved = solve(*made, row); !solved) return tl::unexpected(std::move(solved.error()));
    const auto quality = quality_of(row.picture, samples_.truth);
    if (!quality) return tl::unexpected(quality.error());
    row.quality = *quality;
    return row;
  }

  [[nodiscard]] const std::vector<std::string>& notes() const noexcept { return notes_; }

 private:
  [[nodiscard]] recon::Plan plan_of(const Contender& contender) const {
    recon::Plan plan;
    plan.solver = contender.solver;
    plan.iterations = board_.reconstruction.iterations;
    if (!recon::uses_factor(contender.solver))
      plan.iterations = std::min(more_without_factor * plan.iterations, 1'000'000);
    if (options_.iterations) plan.iterations = static_cast<int>(*options_.iterations);
    plan.relaxation = board_.reconstruction.relaxation;
    plan.op = op_;
    plan.threads = options_.threads ? static_cast<int>(*options_.threads) : board_.reconstruction.threads;
    // The board's rho was chosen for the board's metric, and is no step of pdhg.
    const bool penalised = contender.solver == recon::SolverKind::admm || contender.solver == recon::SolverKind::adm;
    if (penalised && recon::metric_of(contender.basis) == recon::metric_of(board_.reconstruction.basis)) {
      plan.rho = board_.reconstruction.rho.value_or(0.0);
    }
    plan.max_reweighted = static_cast<int>(
        std::count_if(samples_.weights.begin(), samples_.weights.end(), [](float w) { return w != 1.0F; }));
    plan.max_reweighted = std::min(plan.max_reweighted, seeing_);
    plan.measure_gap = true;
    return plan;
  }

  /// By hand, else the board's for the board's own basis, else by rule.
  [[nodiscard]] Result<double> lambda_of(const Contender& contender) const {
    if (options_.lambda) return *options_.lambda;
    const bool boards = contender.basis == board_.reconstruction.basis && shares_objective(contender.solver);
    if (boards && board_.reconstruction.lambda && !options_.sigma) return *board_.reconstruction.lambda;
    return recon::lambda_by_rule(response_, board_.object.rows, board_.object.cols, contender.solver, contender.basis,
                                 samples_.sigma);
  }

  Result<recon::Reconstructor> set_up(const Contender& contender, ComparedRow& row) {
    const auto lambda = lambda_of(contender);
    if (!lambda) return tl::unexpected(lambda.error());
    const recon::Objective objective{contender.basis, contender.constraint, board_.reconstruction.box_lo,
                                     board_.reconstruction.box_hi, *lambda};
    row.lambda = *lambda;
    const recon::Plan plan = plan_of(contender);
    const int rows = board_.object.rows, cols = board_.object.cols;
    if (!recon::uses_factor(contender.solver)) {
      return recon::Reconstructor::create(response_, rows, cols, objective, plan, std::nullopt, progress_);
    }
    const recon::Factor wanted = recon::Reconstructor::wanted_factor(response_, rows, cols, objective, plan);
    for (const recon::Factor& factor : factors_) {
      if (factor.metric != wanted.metric || factor.rho != wanted.rho || factor.rank != wanted.rank) continue;
      return recon::Reconstructor::create(response_, rows, cols, objective, plan, factor, progress_);
    }
    KeptFactor kept(board_.folder / ".cache", {hash_, wanted.rho, wanted.order, wanted.metric, wanted.rank});
    auto made = recon::Reconstructor::create(response_, rows, cols, objective, plan, kept.take(), progress_);
    if (!made) return made;
    if (kept.origin() != FactorOrigin::kept) kept.keep(made->factor());
    notes_.insert(notes_.end(), kept.notes().begin(), kept.notes().end());
    // tikhonov's goes with its lambda, which nobody shares.
    if (contender.solver != recon::SolverKind::tikhonov) factors_.push_back(made->factor());
    return made;
  }

  Result<void> solve(const recon::Reconstructor& solver, ComparedRow& row) {
    struct alignas(recon::core::Workspace::alignment) Line {
      std::byte bytes[recon::core::Workspace::alignment];
    };
    std::vector<Line> workspace((solver.required_bytes() + sizeof(Line) - 1) / sizeof(Line));
    row.picture = hal::Image(solver.image_rows(), solver.image_cols());
    std::vector<double> times;
    double total_ms = 0.0;
    while (times.empty() || (times.size() < most_repeats && total_ms < most_timing_ms)) {
      const std::int64_t began_ns = clock_.now_ns();
      row.info =
          solver.solve(samples_.y, samples_.weights, std::as_writable_bytes(std::span(workspace)), row.picture.pixels);
      times.push_back(static_cast<double>(clock_.now_ns() - began_ns) * 1e-6);
      total_ms += times.back();
    }
    std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
    row.solve_ms = times[times.size() / 2];
    row.rank = solver.plan().rank;
    row.workspace_bytes = solver.required_bytes();
    row.table_bytes = solver.table_bytes();
    if (row.info.health != recon::Health::invalid) return {};
    return hal::fail(hal::ErrorCode::out_of_range,
                     fmt::format("{} with {}", name(row.contender.solver), name(row.contender.basis)),
                     "could not solve the frame: its numbers left the range of float32");
  }

  const Board& board_;
  const CompareOptions& options_;
  const CompareSamples& samples_;
  const hal::Clock& clock_;
  const recon::Progress& progress_;
  std::optional<recon::OperatorKind> op_;
  std::optional<recon::Response> rounded_;  // as a lossy operator holds it
  const recon::Response& response_;         // that solvers are set up with
  std::uint64_t hash_;
  int seeing_;
  std::vector<recon::Factor> factors_;
  std::vector<std::string> notes_;
};

/// tsvd decomposes A A' whole: for an eye that is large and not symmetric that takes many minutes without a word.
bool takes_too_long(const Contender& contender, const CompareOptions& options, const Board& board,
                    const recon::Response& response) {
  if (contender.solver != recon::SolverKind::tsvd || !options.solvers.empty()) return false;
  const auto rows = response.seeing_rows();
  if (static_cast<int>(rows.size()) <= most_for_whole_spectrum) return false;
  const auto images = recon::find_mirror_symmetry(response.select_rows(rows), board.object.rows, board.object.cols);
  return rows.size() / images.order() > most_for_whole_spectrum;
}

std::string title_of(const Contender& c) {
  return fmt::format("{} {} {}", name(c.basis), name(c.constraint), name(c.solver));
}

void fill_excess(std::vector<ComparedRow>& rows) {
  for (ComparedRow& row : rows) {
    if (!shares_objective(row.contender.solver)) continue;
    double least = std::numeric_limits<double>::infinity();
    for (const ComparedRow& other : rows) {
      const bool same = shares_objective(other.contender.solver) && other.contender.basis == row.contender.basis &&
                        other.contender.constraint == row.contender.constraint && other.lambda == row.lambda;
      if (same) least = std::min(least, other.info.objective);
    }
    row.excess = least > 0.0 ? row.info.objective / least - 1.0 : 0.0;
  }
}

}  // namespace

Result<Comparison> compare_all(const Board& board, const CompareOptions& options,
                               const std::vector<Contender>& contenders, CompareSamples samples,
                               const hal::Clock& clock, const recon::Progress& progress) {
  Comparison comparison;
  comparison.board = board.name;
  comparison.scene = samples.scene;
  comparison.exact = options.exact;
  comparison.sigma = samples.sigma;
  comparison.seed = options.seed;
  comparison.scene_seed = options.scene_seed;
  if (!samples.conventional) {
    comparison.notes.emplace_back("the conventional eye is left out: this lattice has no interommatidial angle");
  }
  comparison.channels = samples.response.rows();
  comparison.seeing = static_cast<int>(samples.response.seeing_rows().size());
  if (samples.conventional) {
    const auto quality = quality_of(*samples.conventional, samples.truth);
    if (!quality) return tl::unexpected(quality.error());
    comparison.conventional_quality = *quality;
  }
  double done = 0.0;
  // One stage from the first solver to the last, so that its remaining time means something.
  const recon::Progress overall = [&](std::string_view, double, double) {
    return progress("comparing", done, static_cast<double>(contenders.size()));
  };
  Runner runner(board, options, samples, clock, overall);
  std::optional<hal::Error> first_failure;
  for (const Contender& contender : contenders) {
    if (takes_too_long(contender, options, board, samples.response)) {
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

}  // namespace compueye::firmware
