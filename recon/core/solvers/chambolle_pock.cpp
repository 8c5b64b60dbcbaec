#include "recon/core/solvers/chambolle_pock.hpp"

#include "recon/core/frame/duality_gap.hpp"
#include "recon/core/frame/frame_loop.hpp"
#include "recon/core/parts/proximal.hpp"
#include "recon/core/parts/square_root.hpp"
#include "recon/core/parts/vector_sums.hpp"

namespace compueye::recon::core {
namespace {

template <class T>
class ChambollePock {
 public:
  ChambollePock(const ChambollePockProblem<T>& problem, Workspace& memory) noexcept
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

  bool begin(const float* y, const float* weights) noexcept {
    if (!samples_.gather(y, weights)) return false;
    for (std::size_t k = 0; k < n_; ++k) x_[k] = ahead_[k] = T(0);
    for (std::size_t i = 0; i < problem_.a.rows; ++i) row_dual_[i] = T(0);
    for (std::size_t k = 0; k < coefficient_count_; ++k) basis_dual_[k] = T(0);
    return true;
  }

  void iterate(int) noexcept {
    ascend();
    moved_ = descend();
  }

  bool finish(FrameInfo& info) noexcept {
    analyse(problem_.psi, projected_, coefficients_, scratch_);
    evaluate(samples_, projected_, l1_penalty(problem_, coefficients_), residual_, info);
    // Relaxation may have carried them beyond their bounds.
    for (std::size_t k = 0; k < coefficient_count_; ++k) basis_dual_[k] = within(basis_dual_[k], problem_.lambda);
    info.primal_residual = moved_;
    judge_by_gap(problem_, gap_, gap_.measure(samples_, projected_, basis_dual_, info.objective), still_step, info);
    return all_finite(x_, n_);  // the projection would have turned NaN into a number
  }

  [[nodiscard]] const T* picture() const noexcept { return projected_; }
  [[nodiscard]] const FrameSamples<T>& samples() const noexcept { return samples_; }
  [[nodiscard]] SpareVectors<T> spare() noexcept { return {samples_, residual_, projected_, coefficients_, scratch_}; }

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
    problem_.crew.share(n_, n_, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        projected_[k] = prox_l1_box(x_[k] - problem_.primal_steps[k] * projected_[k], T(0), problem_.lo, problem_.hi);
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

  const ChambollePockProblem<T>& problem_;
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
  double moved_ = 1.0;  // by the last iteration, relative to the picture
};

}  // namespace

template <class T>
const Solver<T> ChambollePockProblem<T>::solver = solver_of<T, ChambollePockProblem, ChambollePock>;
template struct ChambollePockProblem<float>;
template struct ChambollePockProblem<double>;

}  // namespace compueye::recon::core
