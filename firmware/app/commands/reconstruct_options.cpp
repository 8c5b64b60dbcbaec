#include "firmware/app/commands/reconstruct_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "hal/try.hpp"
#include "recon/option_names.hpp"
#include "recon/solver_list.hpp"
#include "recon/worker_threads.hpp"

namespace compueye::firmware {
namespace {

std::vector<std::string_view> operator_words() {
  std::vector<std::string_view> words = recon::words_of(recon::operator_names());
  words.insert(words.begin(), "auto");
  return words;
}

void add_files(OptionList& options, ReconstructOptions& o) {
  options.add("--response", o.response, "measurement matrix A (M, N): .npy dense or .mtx sparse")
      .required()
      .type("FILE");
  options.add("--samples", o.samples, "y: .npy of (M,) or (frames, M), in white pixels").required().type("FILE");
  options.add("--size", o.size, "rows and columns of the picture, H times W = N")
      .required()
      .type("HxW")
      .where(picture_size());
  options.add("--weights", o.weights, "weights >= 0: .npy of (M,) or (frames, M); 0 = channel missing").type("FILE");
  options.add("--truth", o.truth, "true picture(s): .npy of (H, W) or (frames, H, W), for NMSE, PSNR, SSIM")
      .type("FILE");
  options.add("--out", o.out, "x: .npy of (H, W), or (frames, H, W) when the samples have a frames axis").type("FILE");
  options
      .add("--png", o.png,
           "8-bit picture, 0..1 from black to white; several frames become a numbered series: x.png gives "
           "x-0000.png, x-0001.png ...")
      .type("FILE");
}

void add_problem(OptionList& options, ReconstructOptions& o) {
  options.add("--solver", o.solver, choices(recon::words_of(recon::solver_names()), "admm"))
      .type("NAME")
      .where(one_of(recon::words_of(recon::solver_names())));
  options
      .add("--basis", o.basis,
           "where the picture is sparse: " + choices(recon::words_of(recon::basis_names()), "identity"))
      .type("NAME")
      .where(one_of(recon::words_of(recon::basis_names())));
  options.flag("--nonnegative", o.nonnegative, "constraint x >= 0");
  options.add("--box", o.box, "constraint LO <= x <= HI, such as 0,1")
      .type("LO,HI")
      .excludes("--nonnegative")
      .where([](const std::string& text) {
        return interval_from(text) ? std::string()
                                   : "is '" + text + "', expected two finite numbers with the lower first, such as 0,1";
      });
  const auto not_negative = [](double v) { return v >= 0.0; };
  options.add("--lambda", o.lambda, "weight of the penalty, by hand")
      .type("V")
      .where(number_where(not_negative, "a finite number of 0 or more"));
  options.add("--sigma", o.sigma, "noise of a sample (of weight 1) in white pixels: lambda by rule")
      .type("V")
      .excludes("--lambda")
      .where(number_where(not_negative, "a finite number of 0 or more"));
  options
      .flag("--lambda-from-samples", o.lambda_from_samples,
            "choose among six multiples of the rule's lambda by the risk that the first frame shows; costs twelve "
            "frames")
      .needs("--sigma");
  options
      .add("--epsilon", o.epsilon,
           "adm: min ||Psi x||_1 subject to ||W^(1/2)(Ax-y)|| <= V; omp: stop there; in white pixels")
      .type("V")
      .where(number_where(not_negative, "a finite number of 0 or more"));
  options
      .add(
          "--rank", o.rank,
          "tsvd: how many singular values to keep (with --sigma: by rule); pdhg: how many modes to treat exactly (400)")
      .type("R")
      .where(whole_number(1, 1'000'000));
}

void add_plan(OptionList& options, ReconstructOptions& o) {
  options.add("--iterations", o.iterations, "exactly this many a frame (default 100); omp: elements, at most")
      .type("K")
      .where(whole_number(1, 1'000'000));
  options.add("--rho", o.rho, "penalty of admm and adm (default: by rule)")
      .type("V")
      .where(number_where([](double v) { return v > 0.0; }, "a finite number above 0"));
  options
      .add("--reweight", o.reweight,
           "admm in pixels: as many iterations again with weights 2V / (|x| + V), for pictures of few lit pixels; "
           "V about a tenth of their brightness")
      .type("V")
      .where(number_where([](double v) { return v > 0.0; }, "a finite number above 0"));
  options.add("--relaxation", o.relaxation, "of admm and cp (default 1.7)")
      .type("V")
      .where(number_where([](double v) { return v > 0.0 && v < 2.0; }, "a number above 0 and below 2"));
  options.add("--precision", o.precision, "f32 (default) or f64").type("NAME").where(one_of({"f32", "f64"}));
  options
      .add("--start", o.start,
           "with pdhg: cold (default), or warm: a frame goes on from the last one unless it has changed too much")
      .type("NAME")
      .where(one_of({"cold", "warm"}));
  options
      .add("--operator", o.op,
           "how A is applied: auto (default: the quickest that keeps every digit), " +
               choices(recon::words_of(recon::operator_names())) + ", which round the response")
      .type("NAME")
      .where(one_of(operator_words()));
  options.add("--threads", o.threads, "that share a frame's work (default 1); the picture is the same")
      .type("T")
      .where(whole_number(1, recon::WorkerThreads::most));
  options.flag("--as-published", o.as_published,
               "adm as YALL1 v1.4 does it, for comparison: it may stop where there is no solution");
  options.json("print one object with every figure");
}

hal::Result<void> usage(std::string_view option, std::string sentence) {
  return need(false, option, std::move(sentence));
}

/// A file name that ends like something else is most likely two options mixed up. No ending is a device or pipe.
hal::Result<void> check_ending(const char* option, const std::string& file, std::string_view ending, bool or_none) {
  const std::string found = std::filesystem::path(file).extension().string();
  if (file.empty() || found == ending || (or_none && found.empty())) return {};
  return usage(option, "is '" + file + "', expected a file name that ends in " + std::string(ending));
}

hal::Result<void> check_not_input(const char* option, const std::string& file, const ReconstructOptions& o) {
  std::error_code ignored;
  for (const std::string& input : {o.response, o.samples, o.weights, o.truth}) {
    if (!file.empty() && std::filesystem::equivalent(file, input, ignored)) {
      return usage(option, "is '" + file + "', which is read as well, expected another file");
    }
  }
  return {};
}

std::string constraints_of(recon::SolverKind solver, recon::BasisKind basis) {
  std::vector<std::string_view> names;
  for (const auto& constraint : recon::constraint_names()) {
    if (recon::supports(solver, basis, constraint.kind)) names.push_back(constraint.name);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

bool takes_epsilon(const recon::SolverRow& row) {
  return row.takes_epsilon;
}
bool is_direct(const recon::SolverRow& row) {
  return row.direct;
}
bool has_rank(const recon::SolverRow& row) {
  return row.rank == recon::RankUse::singular_values;
}

/// The method as its authors published it, where that is kept for comparison.
recon::SolverKind published_of(const recon::SolverRow& row) {
  return recon::solver_named(std::string(row.name) + " as published");
}

/// The option is not given, or the solver is one of those that take it.
hal::Result<void> only_with(bool given, std::string_view option, std::string_view meaning, recon::SolverKind solver,
                            bool (*takes)(const recon::SolverRow&)) {
  if (!given || takes(*solver)) return {};
  std::vector<std::string_view> takers;
  for (const recon::SolverKind each : recon::solvers()) {
    if (takes(*each)) takers.push_back(each->name);
  }
  return usage(option, fmt::format("is {}, which {} has not; it goes with --solver {} only", meaning, solver->name,
                                   fmt::join(takers, " or ")));
}

hal::Result<void> check_direct(const ReconstructOptions& o, recon::SolverKind solver) {
  if (!solver->direct) return {};
  if (o.iterations || o.rho || o.relaxation) {
    return usage("--solver " + o.solver, "solves directly, so --iterations, --rho and --relaxation do nothing with it");
  }
  if (o.lambda && !(*o.lambda > 0.0)) {
    return usage("--lambda",
                 fmt::format("is 0, expected a number above 0 with {}, where it is {}", o.solver,
                             has_rank(*solver) ? "the least square of a singular value" : "the weight of ||x||^2"));
  }
  return {};
}

hal::Result<void> check_distance(const ReconstructOptions& o, recon::SolverKind solver) {
  const bool cut = o.rank && has_rank(*solver);
  if (o.epsilon || cut) {
    const char* option = o.epsilon ? "--epsilon" : "--rank";
    if (!o.lambda && !o.sigma && !(o.epsilon && cut)) return {};
    return usage(option, "takes the place of --lambda and --sigma, expected only one of them");
  }
  if (o.lambda || o.sigma) return {};
  return usage("--lambda or --sigma",
               "is needed: --sigma takes the noise of one sample in white pixels and finds lambda by rule, --lambda "
               "sets the weight of the penalty by hand (" +
                   recon::names_of_solvers(takes_epsilon, " and ") + " take --epsilon, " +
                   recon::names_of_solvers(has_rank, " and ") + " --rank instead)");
}

/// What goes with what as lines of solver, bases and constraints.
std::string solver_table_text() {
  std::string text = fmt::format("  {:<10}{:<36}{}\n", "solver", "basis", "constraint");
  for (const auto& solver : recon::solver_names()) {
    std::vector<std::pair<std::string, std::string>> lines;  // constraints, bases that take them
    for (const auto& basis : recon::basis_names()) {
      const std::string constraints = constraints_of(solver.kind, basis.kind);
      if (constraints.empty()) continue;
      const auto same = std::find_if(lines.begin(), lines.end(), [&](const auto& l) { return l.first == constraints; });
      if (same == lines.end()) {
        lines.emplace_back(constraints, basis.name);
      } else {
        same->second += ", " + std::string(basis.name);
      }
    }
    for (const auto& [constraints, bases] : lines) {
      text += fmt::format("  {:<10}{:<36}{}\n", solver.name, bases, constraints);
    }
  }
  return text;
}

/// The solver takes this basis with this constraint. Error usage, naming the solvers that do.
hal::Result<void> check_pair(const ProblemStatement& problem) {
  const recon::Objective& objective = problem.objective;
  if (recon::supports(problem.plan.solver, objective.basis, objective.constraint)) return {};
  return usage("--solver", fmt::format("{} does not take basis {} with constraint {}; these solvers do: {}",
                                       name(problem.plan.solver), name(objective.basis), name(objective.constraint),
                                       recon::solvers_for(objective.basis, objective.constraint)));
}

/// Options that only some solvers have are given to those only, and exactly one says how far a solver may stay from y:
/// lambda, sigma, epsilon or rank. Error usage, naming the option and the solvers that take it.
hal::Result<void> check_solver_options(const ReconstructOptions& o) {
  using Row = recon::SolverRow;
  const recon::SolverKind solver = recon::solver_named(o.solver);
  TRY(only_with(o.epsilon.has_value(), "--epsilon", "a bound of the residual", solver, takes_epsilon));
  TRY(only_with(o.rank.has_value(), "--rank", "a number of singular values or modes", solver,
                [](const Row& row) { return row.rank != recon::RankUse::none; }));
  TRY(only_with(o.as_published, "--as-published", "what YALL1 does", solver,
                [](const Row& row) { return published_of(row) != nullptr; }));
  TRY(check_direct(o, solver));
  TRY(only_with(o.rho.has_value(), "--rho", "a penalty or an inverse step", solver, [](const Row& row) {
    return row.rho == recon::RhoUse::penalty || row.rho == recon::RhoUse::inverse_step;
  }));
  TRY(only_with(o.relaxation.has_value(), "--relaxation", "over-relaxation", solver,
                [](const Row& row) { return row.relaxes; }));
  TRY(only_with(o.start == "warm", "--start warm", "a last frame", solver,
                [](const Row& row) { return row.starts_warm(); }));
  TRY(only_with(o.reweight.has_value(), "--reweight", "a second pass", solver,
                [](const Row& row) { return row.reweights; }));
  TRY(need(!o.reweight || o.basis == "identity", "--reweight",
           "is for pictures of few lit pixels, expected --basis identity"));
  return check_distance(o, solver);
}

}  // namespace

void add_reconstruct_options(OptionList& options, ReconstructOptions& request) {
  add_files(options, request);
  add_problem(options, request);
  add_plan(options, request);
}

std::string reconstruct_footer() {
  return "Solves min 1/2 ||W^(1/2)(Ax-y)||^2 + lambda ||Psi x||_1 within the constraint; tikhonov with\n"
         "lambda/2 ||x||^2 instead; adm with --epsilon: min ||Psi x||_1 within it and the constraint; omp as few\n"
         "non-zeros of Psi x as it takes; tsvd the leading singular values only. One unit of y is one fully seen\n"
         "pixel at white; x is in 0..1 of display white.\n\n"
         "What goes with what:\n" +
         solver_table_text() + "docs/solvers.md says which to use when. " +
         recon::names_of_solvers(is_direct, " and ") +
         " solve directly: no iterations, rho or relaxation.\n"
         "One of --lambda, --sigma, --epsilon (" +
         recon::names_of_solvers(takes_epsilon) + ") and --rank (" + recon::names_of_solvers(has_rank) +
         "), always. Weights are inverse variances\n"
         "relative to --sigma; with (frames, M) they change from frame to frame. A NaN in y is an error unless its\n"
         "weight is 0.\n"
         "Ctrl-C leaves no files behind. Exit codes: 0 done, 1 failed, 2 wrong usage.\n\n"
         "Examples:\n"
         "  compueye response --board boards/sim-8x8 --out A.mtx\n"
         "  compueye reconstruct --response A.mtx --samples y.npy --size 16x16 --box 0,1 --sigma 0.002 --png x.png\n"
         "  compueye reconstruct --response A.mtx --samples y.npy --size 16x16 --solver adm --epsilon 0.02 \\\n"
         "                       --iterations 2000 --nonnegative\n"
         "  compueye reconstruct --response A.npy --samples y.npy --size 160x160 --basis dct --box 0,1 --sigma 0.32 "
         "\\\n"
         "                       --weights w.npy --out x.npy --truth truth.npy --json";
}

hal::Result<ProblemStatement> problem_of(const ReconstructOptions& o) {
  TRY(check_solver_options(o));
  TRY(check_ending("--out", o.out, ".npy", true));
  TRY(check_ending("--png", o.png, ".png", false));
  TRY(check_not_input("--out", o.out, o));
  ProblemStatement problem;
  problem.size = *picture_size_from(o.size);
  problem.objective.basis = *recon::kind_of(recon::basis_names(), o.basis);
  if (o.nonnegative) problem.objective.constraint = recon::ConstraintKind::nonnegative;
  if (const auto box = interval_from(o.box)) {
    problem.objective.constraint = recon::ConstraintKind::box;
    problem.objective.lo = box->lo;
    problem.objective.hi = box->hi;
  }
  problem.objective.epsilon = o.epsilon;
  problem.plan.solver = recon::solver_named(o.solver);
  if (o.as_published) problem.plan.solver = published_of(*problem.plan.solver);
  problem.plan.warm_start = o.start == "warm";
  problem.plan.op = recon::kind_of(recon::operator_names(), o.op);
  problem.plan.threads = o.threads;
  problem.plan.rank = o.rank.value_or(0);
  problem.plan.l1_reweighting = o.reweight.value_or(0.0);
  problem.plan.measure_gap = true;
  problem.plan.precision = o.precision == "f64" ? recon::Precision::f64 : recon::Precision::f32;
  problem.plan.iterations = o.iterations.value_or(problem.plan.iterations);
  problem.plan.rho = o.rho.value_or(problem.plan.rho);
  problem.plan.relaxation = o.relaxation.value_or(problem.plan.relaxation);
  TRY(check_pair(problem));
  return problem;
}

}  // namespace compueye::firmware
