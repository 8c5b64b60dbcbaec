#include "studies/accuracy_and_time/sweep_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <string_view>

#include "firmware/operating_points/machine.hpp"
#include "firmware/text/number_text.hpp"
#include "recon/option_names.hpp"
#include "recon/solver_table.hpp"
#include "recon/worker_threads.hpp"
#include "studies/named_kinds.hpp"

namespace compueye::firmware {
namespace {

using recon::BasisKind;
using recon::OperatorKind;
using recon::Precision;
using recon::SolverKind;

constexpr int every_eye = std::numeric_limits<int>::max();

/// A line of the sweep: a solver in one form, in every basis it takes.
struct SweepRow {
  SolverKind solver;
  Precision precision;
  bool boards_basis_only;
  int most_rows;  ///< seeing rows up to which it is swept without being asked for by name
  std::vector<int> iterations;
  std::vector<int> quick;
  std::optional<OperatorKind> op = std::nullopt;  ///< absent: the board's, or the quickest
  Motion motion = Motion::none;                   ///< of a warm start
  bool all_cores = false;                         ///< a thread a core; left out where there is but one
};

/// What is swept. To sweep more, add a line.
const std::vector<SweepRow>& sweep_rows() {
  constexpr int large = 2000;  // rows from which a whole spectrum or a factor in double takes minutes
  static const std::vector<int> factored{1, 2, 3, 5, 8, 12, 20, 30, 50, 80, 120, 200}, few{2, 8, 30, 120};
  static const std::vector<int> first_order{10, 30, 100, 300, 1000, 3000}, few_first_order{30, 300};
  static const std::vector<int> some{5, 12, 30, 80};
  static const std::vector<int> warm{1, 2, 3, 5, 8, 12, 20}, few_warm{2, 5, 12};
  static const std::vector<SweepRow> rows{
      {SolverKind::admm, Precision::f32, false, every_eye, factored, few},
      {SolverKind::pdhg, Precision::f32, false, every_eye, factored, few},
      {SolverKind::pdhg, Precision::f32, true, every_eye, warm, few_warm, {}, Motion::still},
      {SolverKind::pdhg, Precision::f32, true, every_eye, warm, few_warm, {}, Motion::sprite},
      {SolverKind::tikhonov, Precision::f32, false, large, {1}, {1}},
      {SolverKind::adm, Precision::f32, false, every_eye, factored, few},
      {SolverKind::chambolle_pock, Precision::f32, false, every_eye, first_order, few_first_order},
      {SolverKind::fista, Precision::f32, false, every_eye, first_order, few_first_order},
      {SolverKind::omp, Precision::f32, false, large, {5, 10, 20, 50}, {20}},
      {SolverKind::tsvd, Precision::f32, false, large, {1}, {1}},
      {SolverKind::admm, Precision::f32, true, large, some, few, OperatorKind::dense},
      {SolverKind::admm, Precision::f32, true, large, some, few, OperatorKind::csr},
      {SolverKind::pdhg, Precision::f32, true, every_eye, some, few, OperatorKind::dense_runs_int8},
      {SolverKind::pdhg, Precision::f32, true, every_eye, some, few, OperatorKind::dense_runs_bf16},
      {SolverKind::pdhg, Precision::f32, true, every_eye, some, few, OperatorKind::dense_runs},
      {SolverKind::pdhg, Precision::f32, true, every_eye, some, few, OperatorKind::csr},
      {SolverKind::pdhg, Precision::f32, true, every_eye, some, few, {}, Motion::none, true},
      {SolverKind::admm, Precision::f64, true, large, factored, few},
  };
  return rows;
}

bool wanted(const std::vector<std::string>& words, std::string_view word) {
  return words.empty() || std::find(words.begin(), words.end(), word) != words.end();
}

/// The board's own basis first.
std::vector<BasisKind> bases_of(const SweepRow& row, const Board& board, const ParetoOptions& options) {
  std::vector<BasisKind> bases;
  const BasisKind own = board.reconstruction.basis;
  if (wanted(options.bases, recon::name(own))) bases.push_back(own);
  // Those that win most often first, since time may run out.
  for (const BasisKind basis :
       {BasisKind::dct, BasisKind::tv, BasisKind::identity, BasisKind::haar, BasisKind::db4, BasisKind::dft}) {
    if (row.boards_basis_only || basis == own || !wanted(options.bases, recon::name(basis))) continue;
    bases.push_back(basis);
  }
  return bases;
}

std::vector<int> iterations_of(const SweepRow& row, BasisKind basis, const Board& board, bool quick) {
  std::vector<int> iterations = quick ? row.quick : row.iterations;
  const ReconstructionSettings& own = board.reconstruction;
  const bool iterates = row.solver != SolverKind::tikhonov && row.solver != SolverKind::tsvd;
  if (row.solver == own.solver && basis == own.basis && iterates) iterations.push_back(own.iterations);
  std::sort(iterations.begin(), iterations.end());
  iterations.erase(std::unique(iterations.begin(), iterations.end()), iterations.end());
  return iterations;
}

void add_row(const SweepRow& row, const Board& board, const ParetoOptions& options, SweepPlan& plan) {
  for (const BasisKind basis : bases_of(row, board, options)) {
    for (const auto constraint : {board.reconstruction.constraint, recon::ConstraintKind::none}) {
      if (!recon::supports(row.solver, basis, constraint)) continue;
      Curve curve{row.solver, basis, constraint, row.precision};
      curve.op = row.op ? row.op : board.reconstruction.op;
      curve.motion = row.motion;
      if (row.all_cores) curve.threads = std::min(this_machine().cores, recon::WorkerThreads::most);
      // A board that names a form of A has it in two lines of the table, a machine with one core its threads.
      const bool there = std::any_of(plan.curves.begin(), plan.curves.end(),
                                     [&](const PlannedCurve& other) { return other.curve == curve; });
      if (!there) plan.curves.push_back({curve, iterations_of(row, basis, board, options.quick)});
      break;
    }
  }
}

}  // namespace

std::string title(const Curve& curve) {
  std::string text(recon::name(curve.solver));
  if (curve.solver != SolverKind::tikhonov && curve.solver != SolverKind::tsvd) {
    text += ' ';
    text += recon::name(curve.basis);
  }
  if (curve.precision == Precision::f64) text += " f64";
  if (curve.op) text += ", " + std::string(recon::name(*curve.op));
  if (curve.threads > 1) text += fmt::format(", {} threads", curve.threads);
  return curve.motion == Motion::none ? text : text + ", warm, " + std::string(name(curve.motion));
}

hal::Result<SweepPlan> plan_sweep(const Board& board, const ParetoOptions& options, int seeing) {
  if (auto ok = kinds_of("--solvers", options.solvers, recon::solver_names()); !ok) return tl::unexpected(ok.error());
  if (auto ok = kinds_of("--bases", options.bases, recon::basis_names()); !ok) return tl::unexpected(ok.error());
  SweepPlan plan;
  for (const SweepRow& row : sweep_rows()) {
    const std::string_view solver = recon::name(row.solver);
    if (!wanted(options.solvers, solver)) continue;
    if (seeing > row.most_rows && (options.solvers.empty() || row.boards_basis_only)) {
      const Curve form{row.solver, board.reconstruction.basis, {}, row.precision, row.op, row.motion};
      plan.notes.push_back(
          fmt::format("{} is left out: it takes too long or too much memory with more than {} seeing ommatidia{}",
                      row.boards_basis_only ? title(form) : std::string(solver), grouped(row.most_rows),
                      row.boards_basis_only ? "" : fmt::format("; --solvers {} asks for it", solver)));
      continue;
    }
    add_row(row, board, options, plan);
  }
  // What the board would run comes first: a budget may not reach the rest.
  std::stable_partition(plan.curves.begin(), plan.curves.end(), [&](const PlannedCurve& planned) {
    return planned.curve.solver == board.reconstruction.solver && planned.curve.op == board.reconstruction.op &&
           planned.curve.precision == Precision::f32;
  });
  if (!plan.curves.empty()) return plan;
  return hal::fail(hal::ErrorCode::usage, "--solvers",
                   "and --bases leave nothing to measure; `compueye reconstruct --help` says what goes with what");
}

}  // namespace compueye::firmware
