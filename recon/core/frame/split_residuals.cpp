#include "recon/core/frame/split_residuals.hpp"

#include "recon/core/parts/square_root.hpp"
#include "recon/core/parts/vector_sums.hpp"

namespace compueye::recon::core {
namespace {

constexpr double converged_below = 1e-3;

/// sqrt(square / size), the size being at least a ten-thousandth of `other` (squares: a hundredth in length).
double relative(double square, double size, double other) noexcept {
  const double least = 1e-4 * other;
  const double scale = size > least ? size : least;
  return scale > 0.0 ? square_root(square / scale) : 0.0;
}

}  // namespace

template <class T>
void SplitResiduals::add(const T* x, const T* z, const T* before, const T* dual, std::size_t n) noexcept {
  apart += static_cast<double>(squared_distance(x, z, n));
  moved += static_cast<double>(squared_distance(z, before, n));
  of_x += static_cast<double>(dot(x, x, n));
  of_copies += static_cast<double>(dot(z, z, n));
  of_duals += static_cast<double>(dot(dual, dual, n));
}

void SplitResiduals::judge(int iterations, FrameInfo& info) const noexcept {
  const double variables = of_x > of_copies ? of_x : of_copies;
  info.primal_residual = relative(apart, variables, of_duals);
  info.dual_residual = relative(moved, of_duals, variables);
  info.iterations = iterations;
  const bool settled = info.primal_residual < converged_below && info.dual_residual < converged_below;
  info.health = settled ? Health::converged : Health::budget_used;
}

template void SplitResiduals::add(const float*, const float*, const float*, const float*, std::size_t) noexcept;
template void SplitResiduals::add(const double*, const double*, const double*, const double*, std::size_t) noexcept;

}  // namespace compueye::recon::core
