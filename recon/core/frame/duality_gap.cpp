#include "recon/core/frame/duality_gap.hpp"

#include "recon/core/parts/square_root.hpp"
#include "recon/core/parts/vector_sums.hpp"

namespace compueye::recon::core {
namespace {

template <class T>
double largest_magnitude(const T* c, std::size_t n) noexcept {
  double largest = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    const double size = static_cast<double>(c[k] < T(0) ? -c[k] : c[k]);
    if (!(size <= largest)) largest = size;  // keeps a NaN
  }
  return largest;
}

}  // namespace

template <class T>
DualityGap<T>::DualityGap(const FrameProblem<T>& problem, bool wanted, Workspace& workspace) noexcept
    : problem_(problem),
      n_(problem.pixels()),
      one_sided_(problem.constrained && problem.hi >= T(no_bound)),
      boxed_(problem.constrained && !one_sided_),
      defined_(problem.bounded ? !boxed_ : (boxed_ || problem.lambda > T(0))),
      wanted_(wanted && defined_) {
  if (!wanted_) return;
  u_ = workspace.take<T>(problem.a.rows);
  if (problem.psi.kind != BasisKind::identity) {
    excess_ = workspace.take<T>(n_);
    coefficients_ = workspace.take<T>(problem.psi.coefficients());
    scratch_ = workspace.take<T>(problem.psi.scratch_size());
    if (problem.psi.kind == BasisKind::tv) white_ = workspace.take<T>(problem.a.rows);
  }
  back_ = workspace.take<T>(n_);
}

template <class T>
void DualityGap<T>::take_residual(const FrameSamples<T>& samples, const T* x) noexcept {
  samples.residual(x, u_);
  for (std::size_t i = 0; i < problem_.a.rows; ++i) u_[i] *= samples.weights()[i];
}

template <class T>
void DualityGap<T>::take_sizes(const FrameSamples<T>& samples) noexcept {
  u_y_ = u_u_ = 0.0;
  for (std::size_t i = 0; i < problem_.a.rows; ++i) {
    const double u = static_cast<double>(u_[i]), w = static_cast<double>(samples.weights()[i]);
    u_y_ += u * static_cast<double>(samples.values()[i]);
    if (w > 0.0) u_u_ += u * u / w;
  }
}

template <class T>
void DualityGap<T>::back_project(const FrameSamples<T>& samples) noexcept {
  for (std::size_t k = 0; k < n_; ++k) back_[k] = T(0);
  samples.adjoint_accumulate(u_, back_);
}

/// excess = A'u - Psi'q
template <class T>
void DualityGap<T>::pull_by_basis(const T* dual) noexcept {
  synthesise(problem_.psi, dual, excess_, scratch_);
  for (std::size_t k = 0; k < n_; ++k) excess_[k] = back_[k] - excess_[k];
}

/// Differences cannot balance a mean, so u gives way along the white picture until the mean of A'u and of what the
/// bound x >= 0 takes up is zero.
template <class T>
void DualityGap<T>::balance_mean(const FrameSamples<T>& samples) noexcept {
  for (std::size_t k = 0; k < n_; ++k) coefficients_[k] = T(1);
  samples.forward(coefficients_, white_);
  double mean = 0.0, squares = 0.0;
  for (std::size_t k = 0; one_sided_ && k < n_; ++k) mean += excess_[k] < T(0) ? -static_cast<double>(excess_[k]) : 0.0;
  for (std::size_t i = 0; i < problem_.a.rows; ++i) {
    const double a = static_cast<double>(white_[i]);
    mean += a * static_cast<double>(u_[i]);
    squares += a * a * static_cast<double>(samples.weights()[i]);
  }
  if (!(squares > 0.0)) return;
  const double share = mean / squares;
  for (std::size_t i = 0; i < problem_.a.rows; ++i) {
    u_[i] -= static_cast<T>(share * static_cast<double>(white_[i]) * static_cast<double>(samples.weights()[i]));
  }
}

template <class T>
double DualityGap<T>::largest_tv_coefficient(const FrameSamples<T>& samples, const T* dual) noexcept {
  if (one_sided_) pull_by_basis(dual);
  balance_mean(samples);
  // What the bound takes up stays as it was; what is left has a zero mean and is brought back by D (D'D)^+.
  synthesise(problem_.psi, dual, coefficients_, scratch_);
  for (std::size_t k = 0; k < n_; ++k) {
    const T taken = one_sided_ && excess_[k] < T(0) ? -excess_[k] : T(0);
    excess_[k] = taken - coefficients_[k];
  }
  back_project(samples);
  for (std::size_t k = 0; k < n_; ++k) excess_[k] += back_[k];
  dct_forward(problem_.metric.dct, excess_, coefficients_, scratch_);
  coefficients_[0] = T(0);
  for (std::size_t k = 1; k < n_; ++k) {
    const T inverse = problem_.metric.inverse_eigenvalues[k];
    coefficients_[k] *= inverse / (T(1) - inverse);
  }
  dct_inverse(problem_.metric.dct, coefficients_, excess_, scratch_);
  analyse(problem_.psi, excess_, coefficients_, scratch_);
  for (std::size_t k = 0; k < problem_.psi.coefficients(); ++k) coefficients_[k] += dual[k];
  return largest_magnitude(coefficients_, problem_.psi.coefficients());
}

/// The bound that lambda has to be for u to be dual feasible as it is.
template <class T>
double DualityGap<T>::largest_coefficient(const FrameSamples<T>& samples, const T* dual) noexcept {
  if (problem_.psi.kind == BasisKind::tv) return largest_tv_coefficient(samples, dual);
  if (problem_.psi.kind == BasisKind::identity) {
    for (std::size_t k = 0; one_sided_ && k < n_; ++k) back_[k] = back_[k] > T(0) ? back_[k] : T(0);
    return largest_magnitude(back_, n_);
  }
  if (one_sided_) {
    pull_by_basis(dual);
    for (std::size_t k = 0; k < n_; ++k) back_[k] -= excess_[k] < T(0) ? excess_[k] : T(0);
  }
  analyse(problem_.psi, back_, coefficients_, scratch_);
  return largest_magnitude(coefficients_, n_);
}

/// sup over lo <= x <= hi of x'v for the best q that pixels have: towards v = 0, or all the way where only one sign of
/// x is allowed.
template <class T>
double DualityGap<T>::pixel_support(double scale) const noexcept {
  const double lo = static_cast<double>(problem_.lo), hi = static_cast<double>(problem_.hi);
  const double lambda = static_cast<double>(problem_.lambda);
  double support = 0.0;
  for (std::size_t k = 0; k < n_; ++k) {
    const double least = scale * static_cast<double>(back_[k]) - lambda, most = least + 2.0 * lambda;
    double v = least > 0.0 ? least : (most < 0.0 ? most : 0.0);
    if (lo >= 0.0) v = least;
    if (hi <= 0.0) v = most;
    support += v > 0.0 ? hi * v : lo * v;
  }
  return support;
}

/// A box takes any u and q, so all that is left is to scale them well: u alone in pixels, both together in a basis.
template <class T>
double DualityGap<T>::box_dual_value(const T* dual) noexcept {
  const auto value = [this](double scale, double support) {
    return scale * u_y_ - 0.5 * scale * scale * u_u_ - support;
  };
  if (problem_.psi.kind == BasisKind::identity) {
    double best = value(1.0, pixel_support(1.0)), scale = 1.0;
    for (int step = 0; step < 8; ++step) {
      scale *= 0.75;
      const double next = value(scale, pixel_support(scale));
      if (next > best) best = next;
    }
    return best;
  }
  pull_by_basis(dual);
  const double lo = static_cast<double>(problem_.lo), hi = static_cast<double>(problem_.hi);
  double support = 0.0;
  for (std::size_t k = 0; k < n_; ++k) {
    const double v = static_cast<double>(excess_[k]);
    support += v > 0.0 ? hi * v : lo * v;
  }
  double scale = u_u_ > 0.0 ? (u_y_ - support) / u_u_ : 1.0;
  scale = scale > 1.0 ? 1.0 : (scale > 0.0 ? scale : 0.0);
  return value(scale, scale * support);
}

/// The best multiple of u that is feasible.
template <class T>
double DualityGap<T>::scaled_dual_value(double largest) const noexcept {
  const double lambda = problem_.bounded ? 1.0 : static_cast<double>(problem_.lambda);
  if (problem_.bounded) {
    const double value = u_y_ - static_cast<double>(problem_.epsilon) * square_root(u_u_);
    return value > 0.0 && largest > 0.0 ? value * lambda / largest : 0.0;
  }
  double scale = u_u_ > 0.0 ? u_y_ / u_u_ : 0.0;
  if (scale * largest > lambda) scale = lambda / largest;
  if (!(scale > 0.0)) scale = 0.0;
  return scale * u_y_ - 0.5 * scale * scale * u_u_;
}

template <class T>
double DualityGap<T>::measure(const FrameSamples<T>& samples, const T* x, const T* dual, double objective) noexcept {
  if (!wanted_) return -1.0;
  take_residual(samples, x);
  back_project(samples);
  take_sizes(samples);
  const double of_box = boxed_ ? box_dual_value(dual) : 0.0;
  double value = of_box > 0.0 ? of_box : 0.0;  // no objective is below nought
  // What serves x >= 0 serves 0 <= x <= hi as well.
  one_sided_ = one_sided_ || boxed_;
  if (!boxed_ || (problem_.lo == T(0) && problem_.lambda > T(0))) {
    const double largest = largest_coefficient(samples, dual);
    take_sizes(samples);  // tv has moved u
    const double scaled = scaled_dual_value(largest);
    if (scaled > value) value = scaled;
  }
  const double gap = objective - value;
  if (gap != gap) return -1.0;
  return gap > 0.0 ? gap : 0.0;
}

template class DualityGap<float>;
template class DualityGap<double>;

}  // namespace compueye::recon::core
