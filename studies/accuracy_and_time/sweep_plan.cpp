#include "studies/accuracy_and_time/sweep_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <span>
#include <string_view>

#include "firmware/operating_points/machine.hpp"
#include "firmware/text/number_text.hpp"
#include "hal/try.hpp"
#include "recon/option_names.hpp"
#include "recon/solver_list.hpp"
#include "recon/worker_threads.hpp"
#include "studies/named_kinds.hpp"

namespace compueye::firmware {
namespace {

using recon::BasisKind;
using recon::OperatorKind;
using recon::Precision;
using recon::solver_named;
using recon::SolverKind;

constexpr int every_eye = std::numeric_limits<int>::max();
constexpr int large = 2000;  // rows from which a whole spectrum or a factor in double takes minutes

/// Iterations at which a curve is measured, ascending.
struct Steps {
  std::span<const int> whole;
  std::span<const int> quick;
};
constexpr int one[] = {1}, few[] = {2, 8, 30, 120}, some[] = {5, 12, 30, 80}, some_atoms[] = {5, 10, 20, 50};
constexpr int many[] = {1, 2, 3, 5, 8, 12, 20, 30, 50, 80, 120, 200}, from_warm[] = {1, 2, 3, 5, 8, 12, 20};
constexpr int slow[] = {10, 30, 100, 300, 1000, 3000}, few_slow[] = {30, 300}, few_warm[] = {2, 5, 12}, atom[] = {20};
constexpr Steps factored{many, few}, first_order{slow, few_slow}, warm{from_warm, few_warm}, of_forms{some, few};
constexpr Steps atoms{some_atoms, atom}, once{one, one};

/// A solver in one form, and the steps in which it is followed.
struct SweptForm {
  SolverKind solver = recon::default_solver();
  const Steps* steps = &first_order;
  int most_rows = every_eye;  ///< seeing rows up to which it is swept without being asked for by name
  bool boards_basis_only = false;
  Precision precision = Precision::f32;
  std::optional<OperatorKind> op = std::nullopt;  ///< absent: the board's, or the quickest
  Motion motion = Motion::none;                   ///< of a warm start
  bool all_cores = false;                         ///< a thread a core; left out where there is but one
};

/// The solvers that win most often come first, since time may run out.
constexpr std::string_view first_solvers[] = {"admm", "pdhg", "tikhonov"};

/// Those that find every direction at once, and those with a factor, take few iterations; all others many.
SweptForm form_of(SolverKind solver) {
  if (solver->direct) return {solver, &once, large};
  if (solver->lambda == recon::LambdaUse::atoms) return {solver, &atoms, large};
  return {solver, recon::uses_factor(solver) ? &factored : &first_order};
}

std::vector<SweptForm> swept_solvers() {
  std::vector<SweptForm> forms;
  for (const std::string_view name : first_solvers) forms.push_back(form_of(solver_named(name)));
  for (const SolverKind solver : recon::solvers()) {
    if (std::find(std::begin(first_solvers), std::end(first_solvers), solver->name) == std::end(first_solvers)) {
      forms.push_back(form_of(solver));
    }
  }
  return forms;
}

/// Other forms of A, more threads and double, on the quickest solvers and the board's own basis.
const std::vector<SweptForm>& other_forms() {
  constexpr bool own_basis = true;
  const SolverKind admm = solver_named("admm"), pdhg = solver_named("pdhg");
  static const std::vector<SweptForm> forms{
      {admm, &of_forms, large, own_basis, Precision::f32, OperatorKind::dense},
      {admm, &of_forms, large, own_basis, Precision::f32, OperatorKind::csr},
      {pdhg, &of_forms, every_eye, own_basis, Precision::f32, OperatorKind::dense_runs_int8},
      {pdhg, &of_forms, every_eye, own_basis, Precision::f32, OperatorKind::dense_runs_bf16},
      {pdhg, &of_forms, every_eye, own_basis, Precision::f32, OperatorKind::dense_runs},
      {pdhg, &of_forms, every_eye, own_basis, Precision::f32, OperatorKind::csr},
      {pdhg, &of_forms, every_eye, own_basis, Precision::f32, std::nullopt, Motion::none, true},
      {admm, &factored, large, own_basis, Precision::f64},
  };
  return forms;
}

std::vector<SweptForm> swept_forms() {
  std::vector<SweptForm> forms;
  for (const SweptForm& solver : swept_solvers()) {
    forms.push_back(solver);
    if (!solver.solver->starts_warm()) continue;
    for (const Motion motion : {Motion::still, Motion::sprite}) {
      forms.push_back({solver.solver, &warm, every_eye, true, Precision::f32, std::nullopt, motion});
    }
  }
  forms.insert(forms.end(), other_forms().begin(), other_forms().end());
  return forms;
}

bool wanted(const std::vector<std::string>& words, std::string_view word) {
  return words.empty() || std::find(words.begin(), words.end(), word) != words.end();
}

/// The board's own basis first, then those that win most often, since time may run out.
std::vector<BasisKind> bases_of(const SweptForm& form, const Board& board, const SweepOptions& options) {
  std::vector<BasisKind> order{board.objective.basis};
  if (!form.boards_basis_only) {
    order.insert(order.end(), {BasisKind::dct, BasisKind::tv});
    for (const auto& named : recon::basis_names()) order.push_back(named.kind);
  }
  std::vector<BasisKind> bases;
  for (const BasisKind basis : order) {
    const bool there = std::find(bases.begin(), bases.end(), basis) != bases.end();
    if (!there && wanted(options.bases, recon::name(basis))) bases.push_back(basis);
  }
  return bases;
}

std::vector<int> iterations_of(const SweptForm& form, BasisKind basis, const Board& board, bool quick) {
  const std::span<const int> steps = quick ? form.steps->quick : form.steps->whole;
  std::vector<int> iterations(steps.begin(), steps.end());
  const bool own = form.solver == board.plan.solver && basis == board.objective.basis;
  if (own && form.steps != &once) iterations.push_back(board.plan.iterations);
  std::sort(iterations.begin(), iterations.end());
  iterations.erase(std::unique(iterations.begin(), iterations.end()), iterations.end());
  return iterations;
}

void add(const SweptForm& form, const Board& board, const SweepOptions& options, SweepPlan& plan) {
  for (const BasisKind basis : bases_of(form, board, options)) {
    for (const auto constraint : {board.objective.constraint, recon::ConstraintKind::none}) {
      if (!recon::supports(form.solver, basis, constraint)) continue;
      Curve curve{form.solver, basis, constraint, form.precision};
      curve.op = form.op ? form.op : board.plan.op;
      curve.motion = form.motion;
      if (form.all_cores) curve.threads = std::min(this_machine().cores, recon::WorkerThreads::most);
      // A board that names a form of A has it in two lines of the table, a machine with one core its threads.
      const bool there = std::any_of(plan.curves.begin(), plan.curves.end(),
                                     [&](const PlannedCurve& other) { return other.curve == curve; });
      if (!there) plan.curves.push_back({curve, iterations_of(form, basis, board, options.quick)});
      break;
    }
  }
}

std::string left_out_note(const SweptForm& form, const Board& board) {
  const std::string_view solver = recon::name(form.solver);
  const Curve curve{form.solver, board.objective.basis, {}, form.precision, form.op, form.motion};
  return fmt::format("{} is left out: it takes too long or too much memory with more than {} seeing ommatidia{}",
                     form.boards_basis_only ? title(curve) : std::string(solver), grouped(form.most_rows),
                     form.boards_basis_only ? "" : fmt::format("; --solvers {} asks for it", solver));
}

}  // namespace

double SweepOptions::seconds() const noexcept {
  constexpr double usual_s = 600.0, quick_s = 30.0;
  const double s = budget_s.value_or(quick ? quick_s : usual_s);
  return s > 0.0 ? s : std::numeric_limits<double>::infinity();
}

hal::Result<SweepPlan> plan_sweep(const Board& board, const SweepOptions& options, int seeing) {
  static_cast<void>(TRY(kinds_of("--solvers", options.solvers, recon::solver_names())));
  static_cast<void>(TRY(kinds_of("--bases", options.bases, recon::basis_names())));
  SweepPlan plan;
  for (const SweptForm& form : swept_forms()) {
    if (!wanted(options.solvers, recon::name(form.solver))) continue;
    if (seeing > form.most_rows && (options.solvers.empty() || form.boards_basis_only)) {
      plan.notes.push_back(left_out_note(form, board));
    } else {
      add(form, board, options, plan);
    }
  }
  // What the board would run comes first: a budget may not reach the rest.
  std::stable_partition(plan.curves.begin(), plan.curves.end(), [&](const PlannedCurve& planned) {
    return planned.curve.solver == board.plan.solver && planned.curve.op == board.plan.op &&
           planned.curve.precision == Precision::f32;
  });
  if (!plan.curves.empty()) return plan;
  return hal::fail(hal::ErrorCode::usage, "--solvers",
                   "and --bases leave nothing to measure; `compueye reconstruct --help` says what goes with what");
}

}  // namespace compueye::firmware
