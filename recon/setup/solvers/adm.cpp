#include "recon/core/solvers/adm.hpp"

#include <cmath>
#include <numeric>

#include "recon/setup/inverse_tables.hpp"
#include "recon/setup/solver_row_of.hpp"

namespace compueye::recon {
namespace {

struct Method {
  template <class T>
  static hal::Result<std::shared_ptr<core::FrameProblem<T>>> prepare(SetUp<T>& from) {
    auto problem = TRY(begin_factored<core::AdmProblem<T>>(from, classes_of(from)));
    const auto values = from.seeing.values();
    const double magnitudes =
        std::accumulate(values.begin(), values.end(), 0.0, [](double sum, double v) { return sum + std::abs(v); });
    problem->mean_row_sum = static_cast<T>(magnitudes / from.seeing.rows());
    problem->column_norm = static_cast<T>(std::sqrt(from.seeing.squared_norm() / from.seeing.cols()));
    return problem;
  }
};

}  // namespace

extern const SolverRow adm_as_published;
extern const SolverRow adm;  // for recon/solver_list.cpp
constinit const SolverRow adm = solver_row_of<core::AdmProblem, Method>({.factor = FactorUse::inverse,
                                                                         .rho = RhoUse::penalty,
                                                                         .takes_epsilon = true,
                                                                         .published = &adm_as_published,
                                                                         .takes = one_proximal_map});

}  // namespace compueye::recon
