#include "recon/core/frame/black_picture.hpp"

#include "recon/core/parts/square_root.hpp"

namespace compueye::recon::core {
namespace {

/// Rounding of an objective, and of a coefficient beside lambda, relative.
constexpr double near = 1e-5;

template <class T>
double objective_of_black(const FrameSamples<T>& samples, std::size_t rows) noexcept {
  double sum = 0.0;
  for (std::size_t i = 0; i < rows; ++i) {
    const double y = static_cast<double>(samples.values()[i]);
    sum += static_cast<double>(samples.weights()[i]) * y * y;
  }
  return 0.5 * sum;
}

/// Least and greatest of n values and nought.
template <class T>
struct Span {
  T least = T(0), most = T(0);

  Span(const T* values, std::size_t n) noexcept {
    for (std::size_t k = 0; k < n; ++k) {
      if (values[k] < least) least = values[k];
      if (values[k] > most) most = values[k];
    }
  }
};

template <class T>
bool is_optimal(const FrameProblem<T>& problem, const SpareVectors<T>& spare) noexcept {
  const T* weights = spare.samples.weights();
  for (std::size_t i = 0; i < problem.a.rows; ++i) spare.rows[i] = weights[i] * spare.samples.values()[i];
  for (std::size_t k = 0; k < problem.pixels(); ++k) spare.pixels[k] = T(0);
  spare.samples.adjoint_accumulate(spare.rows, spare.pixels);
  const T lambda = problem.lambda * static_cast<T>(1.0 + near);
  const bool pixels = problem.psi.kind == BasisKind::identity;
  // Where x may not fall, a pull downwards is taken up by the constraint.
  const Span<T> pull(spare.pixels, problem.pixels());
  const T bound = pixels ? lambda : T(0);
  if ((problem.lo == T(0) || pull.least >= -bound) && (problem.hi == T(0) || pull.most <= bound)) return true;
  if (pixels || problem.psi.kind == BasisKind::tv) return false;
  analyse(problem.psi, spare.pixels, spare.coefficients, spare.scratch);
  const Span<T> coefficients(spare.coefficients, problem.psi.coefficients());
  return coefficients.least >= -lambda && coefficients.most <= lambda;
}

}  // namespace

template <class T>
void prefer_black(const FrameProblem<T>& problem, const SpareVectors<T>& spare, FrameInfo& info, float* x) noexcept {
  if (problem.bounded || info.health == Health::invalid || problem.lo > T(0) || problem.hi < T(0)) return;
  const double black = objective_of_black(spare.samples, problem.a.rows);
  if (info.objective < (1.0 - near) * black) return;
  const bool optimal = is_optimal(problem, spare);
  if (!optimal && info.objective <= black) return;
  for (std::size_t k = 0; k < problem.pixels(); ++k) x[k] = 0.0F;
  const double nearer = info.objective - black, gap = info.duality_gap - (nearer > 0.0 ? nearer : 0.0);
  if (info.duality_gap >= 0.0) info.duality_gap = optimal || gap < 0.0 ? 0.0 : gap;
  info.health = optimal ? Health::converged : Health::budget_used;
  info.objective = black;
  info.residual = square_root(2.0 * black);
  info.primal_residual = info.dual_residual = 0.0;
}

template void prefer_black(const FrameProblem<float>&, const SpareVectors<float>&, FrameInfo&, float*) noexcept;
template void prefer_black(const FrameProblem<double>&, const SpareVectors<double>&, FrameInfo&, float*) noexcept;

}  // namespace compueye::recon::core
