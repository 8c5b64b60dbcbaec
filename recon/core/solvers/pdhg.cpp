#include "recon/core/solvers/pdhg.hpp"

#include "recon/core/parts/duality_gap.hpp"
#include "recon/core/parts/frame_outcome.hpp"
#include "recon/core/parts/proximal.hpp"
#include "recon/core/parts/relaxed_steps.hpp"
#include "recon/core/parts/square_root.hpp"
#include "recon/core/parts/vector_sums.hpp"
#include "recon/core/parts/warm_start.hpp"
#include "recon/core/parts/weighted_dual_step.hpp"

namespace compueye::recon::core {
namespace {

template <class T>
class Pdhg {
 public:
  Pdhg(const FrameProblem<T>& problem, Workspace& memory) noexcept
      : problem_(problem),
        n_(problem.pixels()),
        sparse_basis_(problem.point.basis != BasisKind::identity),
        in_strips_(problem.point.basis == BasisKind::dct),
        coefficient_count_(sparse_basis_ ? problem.psi.coefficients() : 0),
        dual_count_(in_strips_ ? dct_strips_size(problem.psi.rows, problem.psi.cols) : coefficient_count_),
        warm_start_(problem, memory),
        row_dual_(memory.take<T>(problem.a.rows)),
        x_(memory.take<T>(n_)),
        basis_dual_(memory.take<T>(dual_count_)),
        gradient_(memory.take<T>(n_)),
        ahead_(memory.take<T>(n_)),
        coefficients_(memory.take<T>(coefficient_count_)),
        scratch_(memory.take<T>(sparse_basis_ ? problem.psi.scratch_size() : 0)),
        dual_step_(problem, memory),
        gap_(problem, problem.measure_gap, memory) {
    const T beyond = T(1e30);
    lo_ = problem.constrained && problem.lo > -beyond ? problem.lo : -beyond;
    hi_ = problem.constrained && problem.hi < beyond ? problem.hi : beyond;
  }

  FrameInfo solve(const float* y, const float* weights, float* x) noexcept {
    FrameInfo info = begin_outcome(problem_);
    if (!dual_step_.begin(y, weights)) {
      deliver(x_, false, n_, info, x);
      return info;
    }
    info.warm = warm_start_.allowed(dual_step_);
    if (info.warm) {
      go_on();
    } else {
      start_cold();
    }
    for (int k = 1; k < problem_.point.iterations; ++k) {
      set_penalty(k - 1);
      fall();
      rise(gradient_);
    }
    finish(info);
    deliver(gradient_, finite_, n_, info, x);
    warm_start_.keep(dual_step_.samples(), info.health != Health::invalid);
    return info;
  }

 private:
  void start_cold() noexcept {
    for (std::size_t k = 0; k < n_; ++k) x_[k] = gradient_[k] = T(0);
    for (std::size_t i = 0; i < problem_.a.rows; ++i) row_dual_[i] = T(0);
    for (std::size_t k = 0; k < dual_count_; ++k) basis_dual_[k] = T(0);
  }

  /// The last frame left Psi'q in ahead_.
  void go_on() noexcept {
    for (std::size_t k = 0; k < n_; ++k) gradient_[k] = ahead_[k];
  }

  void set_penalty(int done) noexcept {
    dual_step_.set_level(problem_.schedule.level(static_cast<std::size_t>(done)));
    const T rho = problem_.schedule.penalty[dual_step_.level()];
    descent_ = T(1) / rho;
    threshold_ = sparse_basis_ ? T(0) : problem_.lambda / rho;
    ascent_ = {problem_.basis_step * (rho / problem_.rho), problem_.lambda, problem_.relaxation};
  }

  /// gradient += A'u, then p in its place
  void fall() noexcept {
    dual_step_.samples().adjoint_accumulate(row_dual_, gradient_);
    const std::size_t cols = problem_.image_cols;
    problem_.crew.share_from_middle(problem_.image_rows, n_, [&](std::size_t, std::size_t begin, std::size_t end) {
      const std::size_t at = begin * cols;
      descend(gradient_ + at, descent_, threshold_, lo_, hi_, problem_.relaxation, x_ + at, ahead_ + at,
              (end - begin) * cols);
    });
  }

  /// Both duals, then back = Psi'q, which may be ahead_ itself
  void rise(T* back) noexcept {
    dual_step_.apply(ahead_, row_dual_);
    if (in_strips_) return dct_ascend(problem_.psi.dct, ascent_, ahead_, basis_dual_, back, scratch_);
    if (!sparse_basis_) {
      for (std::size_t k = 0; k < n_; ++k) back[k] = T(0);
      return;
    }
    analyse(problem_.psi, ahead_, coefficients_, scratch_);
    const std::size_t cols = problem_.image_cols;
    problem_.crew.share_from_middle(problem_.image_rows, n_, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t at = begin * cols; at < coefficient_count_; at += n_) {
        ascend(coefficients_ + at, ascent_, basis_dual_ + at, (end - begin) * cols);
      }
    });
    synthesise(problem_.psi, basis_dual_, back, scratch_);
  }

  /// The last iteration: its p, left in gradient_, is the answer.
  void finish(FrameInfo& info) noexcept {
    set_penalty(problem_.point.iterations - 1);
    fall();
    finite_ = all_finite(x_, n_) && all_finite(ahead_, n_);  // the projection would have turned NaN into a number
    const double size = static_cast<double>(dot(gradient_, gradient_, n_));
    const double moved = static_cast<double>(squared_distance(ahead_, gradient_, n_));  // 2 p - x from p
    info.primal_residual = size > 0.0 ? square_root(moved / size) : 0.0;
    // The picture is found; the duals are moved for those who ask for them.
    if (problem_.warm_start || problem_.measure_gap || problem_.point.iterations == 1) rise(ahead_);
    judge(info);
  }

  void judge(FrameInfo& info) noexcept {
    const std::size_t rows = problem_.a.rows;
    const double of_dual = static_cast<double>(dot(row_dual_, row_dual_, rows));
    const double off = static_cast<double>(dot(dual_step_.last_step(), dual_step_.last_step(), rows));
    info.dual_residual = of_dual > 0.0 ? square_root(off / of_dual) : 0.0;
    info.iterations = problem_.point.iterations;
    const T* penalised = gradient_;
    if (sparse_basis_) {
      analyse(problem_.psi, gradient_, coefficients_, scratch_);
      penalised = coefficients_;
    }
    const std::size_t count = sparse_basis_ ? coefficient_count_ : n_;
    const double penalty =
        static_cast<double>(problem_.lambda) * static_cast<double>(sum_of_magnitudes(penalised, count));
    evaluate(dual_step_.samples(), gradient_, penalty, dual_step_.row_scratch(), info);
    info.duality_gap = gap_.measure(dual_step_.samples(), gradient_, bounded_dual(), info.objective);
    const double step = info.primal_residual > info.dual_residual ? info.primal_residual : info.dual_residual;
    info.health = health_by_gap(info.duality_gap, info.objective, step);
  }

  /// In its picture's order. Relaxation may have carried it beyond its bounds.
  const T* bounded_dual() noexcept {
    if (!sparse_basis_ || !problem_.measure_gap) return nullptr;
    const std::size_t cols = problem_.image_cols;
    for (std::size_t k = 0; k < coefficient_count_; ++k) {
      const std::size_t at = in_strips_ ? dct_strip_element(k / cols, k % cols, cols) : k;
      coefficients_[k] = within(basis_dual_[at], problem_.lambda);
    }
    return coefficients_;
  }

  const FrameProblem<T>& problem_;
  std::size_t n_;
  bool sparse_basis_;
  bool in_strips_;  // the basis dual
  std::size_t coefficient_count_;
  std::size_t dual_count_;
  WarmStart<T> warm_start_;
  T* row_dual_;
  T* x_;
  T* basis_dual_;
  T* gradient_;
  T* ahead_;
  T* coefficients_;
  T* scratch_;
  WeightedDualStep<T> dual_step_;
  DualityGap<T> gap_;
  T lo_ = T(0);
  T hi_ = T(0);
  T descent_ = T(0);
  T threshold_ = T(0);
  Ascent<T> ascent_;
  bool finite_ = true;
};

}  // namespace

template <class T>
FrameInfo solve_pdhg(const FrameProblem<T>& problem, const float* y, const float* weights, std::byte* workspace,
                     float* x) noexcept {
  Workspace memory(workspace);
  return Pdhg<T>(problem, memory).solve(y, weights, x);
}

template <class T>
std::size_t pdhg_bytes(const FrameProblem<T>& problem) noexcept {
  Workspace counter;
  const Pdhg<T> pdhg(problem, counter);
  return counter.used();
}

template FrameInfo solve_pdhg(const FrameProblem<float>&, const float*, const float*, std::byte*, float*) noexcept;
template FrameInfo solve_pdhg(const FrameProblem<double>&, const float*, const float*, std::byte*, float*) noexcept;
template std::size_t pdhg_bytes(const FrameProblem<float>&) noexcept;
template std::size_t pdhg_bytes(const FrameProblem<double>&) noexcept;

}  // namespace compueye::recon::core
