#include "recon/core/solvers/chambolle_pock.hpp"

#include "recon/core/parts/duality_gap.hpp"
#include "recon/core/parts/frame_outcome.hpp"
#include "recon/core/parts/proximal.hpp"
#include "recon/core/parts/square_root.hpp"
#include "recon/core/parts/vector_sums.hpp"

namespace compueye::recon::core {
namespace {

template <class T>
class ChambollePock {
 public:
  ChambollePock(const FrameProblem<T>& problem, Workspace& memory) noexcept
      : problem_(problem),
        n_(problem.pixels()),
        coefficient_count_(problem.psi.coefficients()),
        samples_(problem, memory),
        row_dual_(memory.take<T>(problem.a.rows)),
        residual_(memory.take<T>(problem.a.rows)),
        x_(memory.take<T>(n_)),
        ahead_(memory.take<T>(n_)),
        projected_(memory.take<T>(n_)),
        basis_dual_(memory.take<T>(coefficient_count_)),
        coefficients_(memory.take<T>(coefficient_count_)),
        scratch_(memory.take<T>(problem.psi.scratch_size())),
        gap_(problem, true, memory) {}

  FrameInfo solve(const float* y, const float* weights, float* x) noexcept {
    FrameInfo info = begin_outcome(problem_);
    if (!samples_.gather(y, weights)) {
      deliver(projected_, false, n_, info, x);
      return info;
    }
    for (std::size_t k = 0; k < n_; ++k) x_[k] = ahead_[k] = T(0);
    for (std::size_t i = 0; i < problem_.a.rows; ++i) row_dual_[i] = T(0);
    for (std::size_t k = 0; k < coefficient_count_; ++k) basis_dual_[k] = T(0);
    double moved = 1.0;
    for (int k = 0; k < problem_.point.iterations; ++k) {
      ascend();
      moved = descend();
    }
    finish(moved, info);
    deliver(projected_, finite_, n_, info, x);
    return info;
  }

 private:
  /// Duals: u = w (u + s (A x - y)) / (w + s), which is 0 for a missing channel; q = clip(q + s Psi x, +-lambda).
  void ascend() noexcept {
    samples_.residual(ahead_, residual_);
    const T* weights = samples_.weights();
    const T relaxation = problem_.relaxation;
    for (std::size_t i = 0; i < problem_.a.rows; ++i) {
      const T step = problem_.dual_steps[i];
      const T dual = weights[i] * (row_dual_[i] - step * residual_[i]) / (weights[i] + step);
      row_dual_[i] += relaxation * (dual - row_dual_[i]);
    }
    flush_tiny(row_dual_, problem_.a.rows);
    analyse(problem_.psi, ahead_, coefficients_, scratch_);
    problem_.crew.share(coefficient_count_, coefficient_count_, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        const T dual = within(basis_dual_[k] + problem_.basis_step * coefficients_[k], problem_.lambda);
        basis_dual_[k] += relaxation * (dual - basis_dual_[k]);
      }
    });
    flush_tiny(basis_dual_, coefficient_count_);
  }

  /// p = projection(x - t (A'u + Psi'q)), ahead = 2 p - x, x += relaxation (p - x); returns ||p - x|| / ||p||.
  double descend() noexcept {
    synthesise(problem_.psi, basis_dual_, projected_, scratch_);
    samples_.adjoint_accumulate(row_dual_, projected_);
    const T lo = problem_.constrained && problem_.lo > T(-1e30) ? problem_.lo : T(-1e30);
    const T hi = problem_.constrained && problem_.hi < T(1e30) ? problem_.hi : T(1e30);
    problem_.crew.share(n_, n_, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        projected_[k] = prox_l1_box(x_[k] - problem_.primal_steps[k] * projected_[k], T(0), lo, hi);
      }
    });
    flush_tiny(projected_, n_);
    const double size = static_cast<double>(dot(projected_, projected_, n_));
    const double moved = static_cast<double>(squared_distance(projected_, x_, n_));
    for (std::size_t k = 0; k < n_; ++k) {
      ahead_[k] = T(2) * projected_[k] - x_[k];
      x_[k] += problem_.relaxation * (projected_[k] - x_[k]);
    }
    flush_tiny(ahead_, n_);
    flush_tiny(x_, n_);
    return size > 0.0 ? square_root(moved / size) : 0.0;
  }

  void finish(double moved, FrameInfo& info) noexcept {
    finite_ = all_finite(x_, n_);  // the projection would have turned NaN into a number
    analyse(problem_.psi, projected_, coefficients_, scratch_);
    const double penalty = static_cast<double>(problem_.lambda) *
                           static_cast<double>(sum_of_magnitudes(coefficients_, coefficient_count_));
    evaluate(samples_, projected_, penalty, residual_, info);
    // Relaxation may have carried them beyond their bounds.
    for (std::size_t k = 0; k < coefficient_count_; ++k) basis_dual_[k] = within(basis_dual_[k], problem_.lambda);
    const double gap = gap_.measure(samples_, projected_, basis_dual_, info.objective);
    info.duality_gap = problem_.measure_gap ? gap : -1.0;
    info.primal_residual = moved;
    info.iterations = problem_.point.iterations;
    info.health = health_by_gap(gap, info.objective, moved);
  }

  const FrameProblem<T>& problem_;
  std::size_t n_;
  std::size_t coefficient_count_;
  FrameSamples<T> samples_;
  T* row_dual_;
  T* residual_;
  T* x_;
  T* ahead_;
  T* projected_;
  T* basis_dual_;
  T* coefficients_;
  T* scratch_;
  DualityGap<T> gap_;
  bool finite_ = true;
};

}  // namespace

template <class T>
FrameInfo solve_chambolle_pock(const FrameProblem<T>& problem, const float* y, const float* weights,
                               std::byte* workspace, float* x) noexcept {
  Workspace memory(workspace);
  return ChambollePock<T>(problem, memory).solve(y, weights, x);
}

template <class T>
std::size_t chambolle_pock_bytes(const FrameProblem<T>& problem) noexcept {
  Workspace counter;
  const ChambollePock<T> method(problem, counter);
  return counter.used();
}

template FrameInfo solve_chambolle_pock(const FrameProblem<float>&, const float*, const float*, std::byte*,
                                        float*) noexcept;
template FrameInfo solve_chambolle_pock(const FrameProblem<double>&, const float*, const float*, std::byte*,
                                        float*) noexcept;
template std::size_t chambolle_pock_bytes(const FrameProblem<float>&) noexcept;
template std::size_t chambolle_pock_bytes(const FrameProblem<double>&) noexcept;

}  // namespace compueye::recon::core
