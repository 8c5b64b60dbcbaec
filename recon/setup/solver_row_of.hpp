#pragma once

#include "recon/setup/frozen_writer.hpp"
#include "recon/setup/solver_row.hpp"

namespace compueye::recon {

/// A row with the traits of `row`, of the method whose problem is Problem<T> and is made by `Method::prepare<T>`.
template <template <class> class Problem, class Method>
[[nodiscard]] constexpr SolverRow solver_row_of(SolverRow row) {
  row.name = Problem<float>::method;
  row.f32 = {&Problem<float>::solver, &Method::template prepare<float>};
  row.f64 = {&Problem<double>::solver, &Method::template prepare<double>};
  row.freeze = &freeze_problem<Problem<float>>;
  return row;
}

}  // namespace compueye::recon
