#include "recon/setup/inverse_tables.hpp"

#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include "recon/setup/factor_check.hpp"
#include "recon/setup/mirror_symmetry.hpp"
#include "recon/setup/row_norms.hpp"
#include "recon/setup/shorter_side.hpp"

namespace compueye::recon {

template <class T>
core::ClassInverse<T> make_inverse(const ParityClasses& classes, const std::vector<double>& scale, const T* values,
                                   KeptTables& kept) {
  core::ClassInverse<T> inverse;
  inverse.order = static_cast<std::size_t>(classes.rows());
  inverse.classes = classes.count();
  const bool whole = classes.count() == 1 && scale.empty();
  std::vector<std::int32_t> index;
  std::vector<T> share;
  for (std::size_t c = 0; c < classes.count() && !whole; ++c) {
    for (int m = 0; m < classes.rows(); ++m) {
      index.push_back(classes.index(c, m));
      share.push_back(static_cast<T>(classes.share(c, m) * (scale.empty() ? 1.0 : scale[static_cast<std::size_t>(m)])));
    }
  }
  const std::int32_t* indices = kept.keep(std::move(index));
  const T* shares = kept.keep(std::move(share));
  for (std::size_t c = 0; c < classes.count(); ++c) {
    auto& part = inverse.parts[c];
    part.matrix = {static_cast<std::size_t>(classes.order(c)), values};
    values += core::PackedSymmetric<T>::size(part.matrix.order);
    if (whole) continue;
    part.index = indices + c * inverse.order;
    part.share = shares + c * inverse.order;
  }
  return inverse;
}

namespace {

template <class T>
hal::Result<void> fill_pixel_inverse(SetUp<T>& from, core::FactoredProblem<T>& problem) {
  constexpr double rounding = 0.5 * static_cast<double>(std::numeric_limits<T>::epsilon());
  PixelFactor made =
      TRY(pixel_factor(from.seeing, metric_of(from.objective.basis), from.plan.rho, rounding, from.progress));
  problem.rho = static_cast<T>(from.plan.rho);
  problem.pixel_inverse = {problem.pixels(), from.kept.keep(std::move(made.inverse))};
  if (from.plan.max_reweighted > 0) problem.pixel_matrix = {problem.pixels(), from.kept.keep(std::move(made.matrix))};
  return {};
}

}  // namespace

template <class T>
hal::Result<void> fill_inverse(SetUp<T>& from, const ParityClasses& classes, core::FactoredProblem<T>& problem) {
  if (is_tall(from.seeing)) return fill_pixel_inverse(from, problem);
  if (from.stored && from.stored->values.size() != factor_size(classes)) {
    return stale(*from.stored, from.plan, from.seeing.rows());
  }
  problem.rho = static_cast<T>(from.plan.rho);
  const bool tried = from.stored && from.stored->from_file;
  const T* values = nullptr;
  if constexpr (std::is_same_v<T, float>) {
    from.factor.values = from.stored
                             ? std::move(from.stored->values)
                             : TRY(packed_inverse<T>(from.seeing, from.factor.metric, from.plan.rho, from.progress));
    values = from.factor.values.data();
  } else {
    values = from.kept.keep(TRY(packed_inverse<T>(from.seeing, from.factor.metric, from.plan.rho, from.progress)));
  }
  problem.inverse = make_inverse(classes, loud_row_scale(from.seeing, from.plan.rho), values, from.kept);
  if constexpr (std::is_same_v<T, float>) {
    if (tried && !inverts(problem.inverse, from.seeing, problem.metric, from.plan.rho)) return not_a_factor();
  }
  problem.inverse.crew = from.crew;
  return {};
}

template <class T>
ParityClasses classes_of(const SetUp<T>& from) {
  return ParityClasses(from.seeing.rows(), find_mirror_symmetry(from.seeing));
}

template core::ClassInverse<float> make_inverse(const ParityClasses&, const std::vector<double>&, const float*,
                                                KeptTables&);
template core::ClassInverse<double> make_inverse(const ParityClasses&, const std::vector<double>&, const double*,
                                                 KeptTables&);
template hal::Result<void> fill_inverse(SetUp<float>&, const ParityClasses&, core::FactoredProblem<float>&);
template hal::Result<void> fill_inverse(SetUp<double>&, const ParityClasses&, core::FactoredProblem<double>&);
template ParityClasses classes_of(const SetUp<float>&);
template ParityClasses classes_of(const SetUp<double>&);

}  // namespace compueye::recon
