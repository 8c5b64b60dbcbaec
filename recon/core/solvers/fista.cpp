#include "recon/core/solvers/fista.hpp"

#include "recon/core/parts/duality_gap.hpp"
#include "recon/core/parts/frame_outcome.hpp"
#include "recon/core/parts/proximal.hpp"
#include "recon/core/parts/square_root.hpp"
#include "recon/core/parts/vector_sums.hpp"

namespace compueye::recon::core {
namespace {

template <class T>
class Fista {
 public:
  Fista(const FrameProblem<T>& problem, Workspace& memory) noexcept
      : problem_(problem),
        n_(problem.pixels()),
        samples_(problem, memory),
        residual_(memory.take<T>(problem.a.rows)),
        point_(memory.take<T>(n_)),
        last_(memory.take<T>(n_)),
        next_(memory.take<T>(n_)),
        picture_(memory.take<T>(n_)),
        gradient_(memory.take<T>(n_)),
        scratch_(memory.take<T>(problem.psi.scratch_size())),
        gap_(problem, true, memory) {}

  FrameInfo solve(const float* y, const float* weights, float* x) noexcept {
    FrameInfo info = begin_outcome(problem_);
    if (!samples_.gather(y, weights)) {
      deliver(picture_, false, n_, info, x);
      return info;
    }
    for (std::size_t k = 0; k < n_; ++k) point_[k] = last_[k] = T(0);
    double momentum = 1.0;
    double step_share = 1.0;
    for (int k = 0; k < problem_.point.iterations; ++k) step_share = iterate(momentum);
    finish(step_share, info);
    deliver(picture_, all_finite(point_, n_), n_, info, x);
    return info;
  }

 private:
  /// point -> next by a proximal gradient step; returns how far it went, relative to the size of next.
  double iterate(double& momentum) noexcept {
    const T step = T(1) / problem_.lipschitz;
    synthesise(problem_.psi, point_, picture_, scratch_);
    samples_.residual(picture_, residual_);
    for (std::size_t i = 0; i < problem_.a.rows; ++i) residual_[i] *= samples_.weights()[i];
    for (std::size_t k = 0; k < n_; ++k) picture_[k] = T(0);
    samples_.adjoint_accumulate(residual_, picture_);
    analyse(problem_.psi, picture_, gradient_, scratch_);
    const bool pixels = problem_.psi.kind == BasisKind::identity && problem_.constrained;
    const T lo = pixels && problem_.lo > T(-1e30) ? problem_.lo : T(-1e30);
    const T hi = pixels && problem_.hi < T(1e30) ? problem_.hi : T(1e30);
    problem_.crew.share(n_, n_, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        next_[k] = prox_l1_box(point_[k] + step * gradient_[k], step * problem_.lambda, lo, hi);
      }
    });
    flush_tiny(next_, n_);
    const double moved = static_cast<double>(squared_distance(next_, point_, n_));
    const double size = static_cast<double>(dot(next_, next_, n_));
    extrapolate(momentum);
    return size > 0.0 ? square_root(moved / size) : 0.0;
  }

  /// point = next + beta (next - last), or a restart when the momentum points uphill.
  void extrapolate(double& momentum) noexcept {
    double uphill = 0.0;
    for (std::size_t k = 0; k < n_; ++k) {
      uphill += static_cast<double>(point_[k] - next_[k]) * static_cast<double>(next_[k] - last_[k]);
    }
    if (uphill > 0.0) momentum = 1.0;
    const double grown = 0.5 * (1.0 + square_root(1.0 + 4.0 * momentum * momentum));
    const T beta = static_cast<T>((momentum - 1.0) / grown);
    momentum = grown;
    for (std::size_t k = 0; k < n_; ++k) {
      point_[k] = next_[k] + beta * (next_[k] - last_[k]);
      last_[k] = next_[k];
    }
    flush_tiny(point_, n_);
  }

  void finish(double step_share, FrameInfo& info) noexcept {
    synthesise(problem_.psi, last_, picture_, scratch_);
    const double penalty = static_cast<double>(problem_.lambda) * static_cast<double>(sum_of_magnitudes(last_, n_));
    evaluate(samples_, picture_, penalty, residual_, info);
    const double gap = gap_.measure(samples_, picture_, nullptr, info.objective);
    info.duality_gap = problem_.measure_gap ? gap : -1.0;
    info.primal_residual = step_share;
    info.iterations = problem_.point.iterations;
    info.health = health_by_gap(gap, info.objective, step_share);
  }

  const FrameProblem<T>& problem_;
  std::size_t n_;
  FrameSamples<T> samples_;
  T* residual_;
  T* point_;     // where the gradient is taken
  T* last_;      // the iterate before
  T* next_;      // the iterate
  T* picture_;   // Psi' point, then A' W (y - A Psi' point)
  T* gradient_;  // its coefficients
  T* scratch_;
  DualityGap<T> gap_;
};

}  // namespace

template <class T>
FrameInfo solve_fista(const FrameProblem<T>& problem, const float* y, const float* weights, std::byte* workspace,
                      float* x) noexcept {
  Workspace memory(workspace);
  return Fista<T>(problem, memory).solve(y, weights, x);
}

template <class T>
std::size_t fista_bytes(const FrameProblem<T>& problem) noexcept {
  Workspace counter;
  const Fista<T> fista(problem, counter);
  return counter.used();
}

template FrameInfo solve_fista(const FrameProblem<float>&, const float*, const float*, std::byte*, float*) noexcept;
template FrameInfo solve_fista(const FrameProblem<double>&, const float*, const float*, std::byte*, float*) noexcept;
template std::size_t fista_bytes(const FrameProblem<float>&) noexcept;
template std::size_t fista_bytes(const FrameProblem<double>&) noexcept;

}  // namespace compueye::recon::core
