#include "recon/core/solvers/fista.hpp"

#include "recon/core/frame/duality_gap.hpp"
#include "recon/core/frame/frame_loop.hpp"
#include "recon/core/parts/proximal.hpp"
#include "recon/core/parts/square_root.hpp"
#include "recon/core/parts/vector_sums.hpp"

namespace compueye::recon::core {
namespace {

template <class T>
class Fista {
 public:
  Fista(const FistaProblem<T>& problem, Workspace& memory) noexcept
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

  bool begin(const float* y, const float* weights) noexcept {
    if (!samples_.gather(y, weights)) return false;
    for (std::size_t k = 0; k < n_; ++k) point_[k] = last_[k] = T(0);
    momentum_ = 1.0;
    return true;
  }

  /// point -> next by a proximal gradient step
  void iterate(int) noexcept {
    const T step = T(1) / problem_.lipschitz;
    synthesise(problem_.psi, point_, picture_, scratch_);
    samples_.residual(picture_, residual_);
    for (std::size_t i = 0; i < problem_.a.rows; ++i) residual_[i] *= samples_.weights()[i];
    for (std::size_t k = 0; k < n_; ++k) picture_[k] = T(0);
    samples_.adjoint_accumulate(residual_, picture_);
    analyse(problem_.psi, picture_, gradient_, scratch_);
    problem_.crew.share(n_, n_, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        next_[k] = prox_l1_box(point_[k] + step * gradient_[k], step * problem_.lambda, problem_.lo, problem_.hi);
      }
    });
    flush_tiny(next_, n_);
    const double moved = static_cast<double>(squared_distance(next_, point_, n_));
    const double size = static_cast<double>(dot(next_, next_, n_));
    moved_ = size > 0.0 ? square_root(moved / size) : 0.0;
    extrapolate();
  }

  bool finish(FrameInfo& info) noexcept {
    synthesise(problem_.psi, last_, picture_, scratch_);
    evaluate(samples_, picture_, l1_penalty(problem_, last_), residual_, info);
    info.primal_residual = moved_;
    judge_by_gap(problem_, gap_, gap_.measure(samples_, picture_, nullptr, info.objective), still_step, info);
    return all_finite(point_, n_);
  }

  [[nodiscard]] const T* picture() const noexcept { return picture_; }
  [[nodiscard]] const FrameSamples<T>& samples() const noexcept { return samples_; }
  [[nodiscard]] SpareVectors<T> spare() noexcept { return {samples_, residual_, picture_, gradient_, scratch_}; }

 private:
  /// point = next + beta (next - last), or a restart when the momentum points uphill.
  void extrapolate() noexcept {
    double uphill = 0.0;
    for (std::size_t k = 0; k < n_; ++k) {
      uphill += static_cast<double>(point_[k] - next_[k]) * static_cast<double>(next_[k] - last_[k]);
    }
    if (uphill > 0.0) momentum_ = 1.0;
    const double grown = 0.5 * (1.0 + square_root(1.0 + 4.0 * momentum_ * momentum_));
    const T beta = static_cast<T>((momentum_ - 1.0) / grown);
    momentum_ = grown;
    for (std::size_t k = 0; k < n_; ++k) {
      point_[k] = next_[k] + beta * (next_[k] - last_[k]);
      last_[k] = next_[k];
    }
    flush_tiny(point_, n_);
  }

  const FistaProblem<T>& problem_;
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
  double momentum_ = 1.0;
  double moved_ = 1.0;  // by the last iteration, relative to the iterate
};

}  // namespace

template <class T>
const Solver<T> FistaProblem<T>::solver = solver_of<T, FistaProblem, Fista>;
template struct FistaProblem<float>;
template struct FistaProblem<double>;

}  // namespace compueye::recon::core
