#pragma once

#include "recon/core/frame/frame_problem.hpp"
#include "recon/setup/mirror_symmetry.hpp"
#include "recon/setup/solver_row.hpp"

namespace compueye::recon {

/// A view of `values`, which are packed as Factor::values are and outlive it, scaled back by `scale`, the
/// loud_row_scale() that they were made with.
template <class T>
[[nodiscard]] core::ClassInverse<T> make_inverse(const ParityClasses& classes, const std::vector<double>& scale,
                                                 const T* values, KeptTables& kept);

/// A problem with what all methods share and the cached inverse, the stored one or a new one. In float32 it is
/// from.factor that owns it. Errors: those of fill_shared() and packed_inverse(), stale.
template <class Problem, class T>
[[nodiscard]] hal::Result<std::shared_ptr<Problem>> begin_factored(SetUp<T>& from, const ParityClasses& classes);

template <class T>
[[nodiscard]] hal::Result<void> fill_inverse(SetUp<T>& from, const ParityClasses& classes,
                                             core::FactoredProblem<T>& problem);

template <class Problem, class T>
hal::Result<std::shared_ptr<Problem>> begin_factored(SetUp<T>& from, const ParityClasses& classes) {
  auto problem = TRY(begin_problem<Problem>(from));
  TRY(fill_inverse<T>(from, classes, *problem));
  return problem;
}

/// Of the rows of a set-up.
template <class T>
[[nodiscard]] ParityClasses classes_of(const SetUp<T>& from);

}  // namespace compueye::recon
