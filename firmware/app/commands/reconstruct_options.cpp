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

namespace compueye::firmware {
namespace {

void add_files(OptionList& options, ReconstructOptions& o) {
  options
      .add("--response", o.response,
           "measurement matrix A (M, N): .npy dense, .mtx sparse, or .eye with its newest one")
      .type("FILE");
  options.add("--eye", o.eye, "the same, for an eye file of whatever name").type("FILE").excludes("--response");
  options.add("--distance", o.distance_mm, "of an eye file's estimate in mm (default: the newest of all)")
      .type("MM")
      .where(length_mm());
  options.add("--samples", o.samples, "y: .npy of (M,) or (frames, M), in white pixels").required().type("FILE");
  options.add("--size", o.size, "rows and columns of the picture, H times W = N; an eye file has them")
      .type("HxW")
      .where(picture_size());
  options.add("--weights", o.weights, "weights >= 0: .npy of (M,) or (frames, M); 0 = channel missing").type("FILE");
  options.add("--truth", o.truth, "true picture(s): .npy of (H, W) or (frames, H, W), for NMSE, PSNR, SSIM")
      .type("FILE");
  options.add("--out", o.out, "x: .npy of (H, W), or (frames, H, W) when the samples have a frames axis")
      .type("FILE")
      .output();
  options
      .add("--png", o.png,
           "8-bit picture, 0..1 from black to white; several frames become a numbered series: x.png gives "
           "x-0000.png, x-0001.png ...")
      .type("FILE")
      .output();
}

void add_problem(OptionList& options, ReconstructOptions& o) {
  options.flag("--nonnegative", o.nonnegative, "constraint x >= 0");
  options.settings("reconstruct", o.settings);
  options
      .flag("--lambda-from-samples", o.lambda_from_samples,
            "choose among multiples of the rule's lambda by the risk that the first frame shows: best where noise is "
            "large; costs up to thirty frames")
      .needs("--sigma");
  options.flag("--as-published", o.as_published,
               "adm as YALL1 v1.4 does it, for comparison: it may stop where there is no solution");
  options.json("print one object with every figure");
  // Without a board there is no noise to fall back on, and no constraint beside the box.
  options.at("--lambda").meaning = "weight of the penalty, by hand";
  options.at("--sigma").excludes("--lambda").meaning =
      "noise of a sample (of weight 1) in white pixels: lambda by rule";
  options.at("--box").excludes("--nonnegative").meaning = "constraint LO <= x <= HI, such as 0,1";
  options.at("--iterations").meaning += "; omp: elements, at most";
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
  for (const std::string& input : {o.response_file(), o.samples, o.weights, o.truth}) {
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

hal::Result<void> check_response(const ReconstructOptions& o) {
  TRY(need(!o.response_file().empty(), "--response", "is missing, for example --response A.mtx, or --eye F.eye"));
  TRY(need(o.from_eye_file() || !o.size.empty(), "--size",
           "is missing, for example --size 16x16; only an eye file says it by itself"));
  return need(o.from_eye_file() || !o.distance_mm, "--distance",
              "chooses among the estimates of an eye file, add --eye");
}

hal::Result<void> check_direct(const Overrides& given, const Board& board) {
  const recon::SolverRow& solver = *board.plan.solver;
  if (!solver.direct) return {};
  if (given.has("--iterations") || given.has("--rho") || given.has("--relaxation")) {
    return usage(fmt::format("--solver {}", solver.name),
                 "solves directly, so --iterations, --rho and --relaxation do nothing with it");
  }
  if (board.lambda && !(*board.lambda > 0.0)) {
    return usage("--lambda",
                 fmt::format("is 0, expected a number above 0 with {}, where it is {}", solver.name,
                             has_rank(solver) ? "the least square of a singular value" : "the weight of ||x||^2"));
  }
  return {};
}

hal::Result<void> check_distance(const Board& board) {
  const bool epsilon = board.objective.epsilon.has_value(), cut = board.plan.rank > 0 && has_rank(*board.plan.solver);
  const bool weighted = board.lambda || board.sigma;
  if (epsilon || cut) {
    if (!weighted && !(epsilon && cut)) return {};
    return usage(epsilon ? "--epsilon" : "--rank",
                 "takes the place of --lambda and --sigma, expected only one of them");
  }
  if (weighted) return {};
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
hal::Result<void> check_pair(const Board& board) {
  const recon::Objective& objective = board.objective;
  if (recon::supports(board.plan.solver, objective.basis, objective.constraint)) return {};
  return usage("--solver", fmt::format("{} does not take basis {} with constraint {}; these solvers do: {}",
                                       name(board.plan.solver), name(objective.basis), name(objective.constraint),
                                       recon::solvers_for(objective.basis, objective.constraint)));
}

/// Options that only some solvers have are given to those only, and exactly one says how far a solver may stay from y:
/// lambda, sigma, epsilon or rank. Error usage, naming the option and the solvers that take it.
hal::Result<void> check_solver_options(const ReconstructOptions& o, const Board& board) {
  const recon::SolverRow& solver = *board.plan.solver;
  TRY(check_direct(o.settings, board));
  TRY(o.settings.check_solver(solver));
  if (o.as_published) {
    TRY(need_solver(
        solver, [](const recon::SolverRow& row) { return row.published != nullptr; }, "--as-published",
        "what YALL1 does"));
  }
  TRY(need(!o.settings.has("--reweight") || board.objective.basis == recon::BasisKind::identity, "--reweight",
           "is for pictures of few lit pixels, expected --basis identity"));
  return check_distance(board);
}

}  // namespace

void add_reconstruct_options(OptionList& options, ReconstructOptions& request) {
  add_files(options, request);
  add_problem(options, request);
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
         "relative to --sigma; with (frames, M) they change from frame to frame. A NaN in y counts where its weight\n"
         "is not 0: that frame is black and told, an error where there is no other.\n"
         "Ctrl-C leaves no files behind. Exit codes: 0 done, 1 failed, 2 wrong usage.\n\n"
         "Examples:\n"
         "  compueye response --board boards/sim-8x8 --out A.mtx\n"
         "  compueye reconstruct --response A.mtx --samples y.npy --size 16x16 --box 0,1 --sigma 0.002 --png x.png\n"
         "  compueye reconstruct --response A.mtx --samples y.npy --size 16x16 --solver adm --epsilon 0.02 \\\n"
         "                       --iterations 2000 --nonnegative\n"
         "  compueye reconstruct --response A.npy --samples y.npy --size 160x160 --basis dct --box 0,1 --sigma 0.32 "
         "\\\n"
         "                       --weights w.npy --out x.npy --truth truth.npy --json\n"
         "  compueye reconstruct --eye F.eye --samples y.npy --sigma 0.002 --box 0,1 --png x.png";
}

bool ReconstructOptions::from_eye_file() const {
  return !eye.empty() || std::filesystem::path(response).extension() == ".eye";
}

hal::Result<ProblemStatement> problem_of(const ReconstructOptions& o) {
  TRY(check_response(o));
  ProblemStatement problem{picture_size_from(o.size), {}};
  Board& board = problem.board;
  TRY(o.settings.apply(board));
  TRY(check_solver_options(o, board));
  TRY(check_ending("--out", o.out, ".npy", true));
  TRY(check_ending("--png", o.png, ".png", false));
  TRY(check_not_input("--out", o.out, o));
  if (o.nonnegative) board.objective.constraint = recon::ConstraintKind::nonnegative;
  if (o.as_published) board.plan.solver = board.plan.solver->published;
  board.plan.measure_gap = true;
  TRY(check_pair(board));
  return problem;
}

}  // namespace compueye::firmware
