#pragma once

#include <string>
#include <vector>

#include "recon/option_names.hpp"
#include "recon/reconstructor.hpp"
#include "recon/solver_list.hpp"

namespace compueye::tests {

struct SolverSetting {
  std::string name;
  recon::Objective objective;
  recon::Plan plan;
};

/// Every solver, as published too, with every basis and constraint it takes, in both precisions; with an epsilon
/// besides where there is such a form. Lambda .1, 5 iterations, at most 6 reweighted channels.
inline std::vector<SolverSetting> every_setting() {
  std::vector<recon::SolverKind> solvers{recon::solver_named("adm as published")};
  for (const auto& solver : recon::solver_names()) solvers.push_back(solver.kind);
  std::vector<SolverSetting> all;
  for (const recon::SolverKind solver : solvers) {
    for (const auto& basis : recon::basis_names()) {
      for (const auto& constraint : recon::constraint_names()) {
        if (!recon::supports(solver, basis.kind, constraint.kind)) continue;
        for (const auto precision : {recon::Precision::f32, recon::Precision::f64}) {
          SolverSetting setting;
          setting.name = std::string(recon::name(solver)) + ' ' + std::string(basis.name) + ' ' +
                         std::string(constraint.name) + (precision == recon::Precision::f32 ? " f32" : " f64");
          setting.objective.basis = basis.kind;
          setting.objective.constraint = constraint.kind;
          setting.objective.lambda = 0.1;
          setting.plan.solver = solver;
          setting.plan.precision = precision;
          setting.plan.iterations = 5;
          setting.plan.max_reweighted = 6;
          setting.plan.measure_gap = true;
          all.push_back(setting);
          if (solver != recon::solver_named("adm") && solver != recon::solver_named("omp")) continue;
          setting.name += " epsilon";
          setting.objective.epsilon = 0.5;
          all.push_back(setting);
        }
      }
    }
  }
  return all;
}

}  // namespace compueye::tests
