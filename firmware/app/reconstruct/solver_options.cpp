#include "firmware/app/reconstruct/solver_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <string_view>
#include <utility>
#include <vector>

#include "recon/option_names.hpp"
#include "recon/solver_table.hpp"

namespace compueye::firmware {
namespace {

using Result = hal::Result<void>;

Result usage(std::string_view option, std::string sentence) {
  return hal::fail(hal::ErrorCode::usage, std::string(option), std::move(sentence));
}

std::string constraints_of(recon::SolverKind solver, recon::BasisKind basis) {
  std::vector<std::string_view> names;
  for (const auto& constraint : recon::constraint_names()) {
    if (recon::supports(solver, basis, constraint.kind)) names.push_back(constraint.name);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

/// The option is not given, or the solver is one of those that take it.
Result only_with(bool given, std::string_view option, std::string_view meaning, const std::string& solver,
                 std::initializer_list<std::string_view> takers) {
  if (!given || std::find(takers.begin(), takers.end(), solver) != takers.end()) return {};
  return usage(option, fmt::format("is {}, which {} has not; it goes with --solver {} only", meaning, solver,
                                   fmt::join(takers, " or ")));
}

Result check_direct(const ReconstructOptions& o) {
  if (o.solver != "tikhonov" && o.solver != "tsvd") return {};
  if (o.iterations || o.rho || o.relaxation) {
    return usage("--solver " + o.solver, "solves directly, so --iterations, --rho and --relaxation do nothing with it");
  }
  if (o.lambda && !(*o.lambda > 0.0)) {
    return usage("--lambda",
                 fmt::format("is 0, expected a number above 0 with {}, where it is {}", o.solver,
                             o.solver == "tsvd" ? "the least square of a singular value" : "the weight of ||x||^2"));
  }
  return {};
}

Result check_distance(const ReconstructOptions& o) {
  const bool cut = o.rank && o.solver == "tsvd";
  if (o.epsilon || cut) {
    const char* option = o.epsilon ? "--epsilon" : "--rank";
    if (!o.lambda && !o.sigma && !(o.epsilon && cut)) return {};
    return usage(option, "takes the place of --lambda and --sigma, expected only one of them");
  }
  if (o.lambda || o.sigma) return {};
  return usage("--lambda or --sigma",
               "is needed: --sigma takes the noise of one sample in white pixels and finds lambda by rule, --lambda "
               "sets the weight of the penalty by hand (adm and omp take --epsilon, tsvd --rank instead)");
}

}  // namespace

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

Result check_pair(const ProblemStatement& problem) {
  const recon::Objective& objective = problem.objective;
  if (recon::supports(problem.plan.solver, objective.basis, objective.constraint)) return {};
  return usage("--solver", fmt::format("{} does not take basis {} with constraint {}; these solvers do: {}",
                                       name(problem.plan.solver), name(objective.basis), name(objective.constraint),
                                       recon::solvers_for(objective.basis, objective.constraint)));
}

Result check_solver_options(const ReconstructOptions& o) {
  return only_with(o.epsilon.has_value(), "--epsilon", "a bound of the residual", o.solver, {"adm", "omp"})
      .and_then([&] {
        return only_with(o.rank.has_value(), "--rank", "a number of singular values or modes", o.solver,
                         {"tsvd", "pdhg"});
      })
      .and_then([&] { return only_with(o.as_published, "--as-published", "what YALL1 does", o.solver, {"adm"}); })
      .and_then([&] { return check_direct(o); })
      .and_then([&] {
        return only_with(o.rho.has_value(), "--rho", "a penalty or an inverse step", o.solver, {"admm", "adm", "pdhg"});
      })
      .and_then([&] {
        return only_with(o.relaxation.has_value(), "--relaxation", "over-relaxation", o.solver, {"admm", "cp", "pdhg"});
      })
      .and_then([&] { return only_with(o.start == "warm", "--start warm", "a last frame", o.solver, {"pdhg"}); })
      .and_then([&] { return only_with(o.reweight.has_value(), "--reweight", "a second pass", o.solver, {"admm"}); })
      .and_then([&] {
        if (!o.reweight || o.basis == "identity") return Result{};
        return usage("--reweight", "is for pictures of few lit pixels, expected --basis identity");
      })
      .and_then([&] { return check_distance(o); });
}

}  // namespace compueye::firmware
