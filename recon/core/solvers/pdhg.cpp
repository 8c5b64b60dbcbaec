#include "recon/core/solvers/pdhg.hpp"

#include "recon/core/frame/duality_gap.hpp"
#include "recon/core/frame/frame_loop.hpp"
#include "recon/core/frame/warm_start.hpp"
#include "recon/core/frame/weighted_dual_step.hpp"
#include "recon/core/parts/proximal.hpp"
#include "recon/core/parts/square_root.hpp"
#include "recon/core/parts/vector_sums.hpp"

namespace compueye::recon::core {
namespace {

template <class T>
class Pdhg {
 public:
  Pdhg(const PdhgProblem<T>& problem, Workspace& memory) noexcept
      : problem_(problem),
        n_(problem.pixels()),
        sparse_basis_(problem.point.basis != BasisKind::identity),
        in_strips_(problem.point.basis == BasisKind::dct),
        coefficient_count_(sparse_basis_ ? problem.psi.coefficients() : 0),
        dual_count_(in_strips_ ? dct_strips_size(problem.psi.rows, problem.psi.cols) : coefficient_count_),
        warm_start_(problem, problem.warm_start, problem.rho, memory),
        row_dual_(memory.take<T>(problem.a.rows)),
        x_(memory.take<T>(n_)),
        basis_dual_(memory.take<T>(dual_count_)),
        gradient_(memory.take<T>(n_)),
        ahead_(memory.take<T>(n_)),
        coefficients_(memory.take<T>(coefficient_count_)),
        scratch_(memory.take<T>(sparse_basis_ ? problem.psi.scratch_size() : 0)),
        dual_step_(problem, problem.dual_step, problem.relaxation, memory),
        gap_(problem, problem.measure_gap, memory) {}

  bool begin(const float* y, const float* weights) noexcept {
    if (!dual_step_.begin(y, weights)) return false;
    warm_ = warm_start_.allowed(dual_step_);
    if (warm_) {
      go_on();
    } else {
      start_cold();
    }
    return true;
  }

  /// The last one's p, left in gradient_, is the answer; its duals are moved for those who ask for them.
  void iterate(int k) noexcept {
    const bool last = k == problem_.point.iterations;
    set_penalty(k - 1);
    fall();
    if (!last) rise(gradient_);
    if (last) follow_last_step();
  }

  bool finish(FrameInfo& info) noexcept {
    info.warm = warm_;
    info.primal_residual = moved_;
    judge(info);
    return finite_;
  }

  [[nodiscard]] const T* picture() const noexcept { return gradient_; }
  [[nodiscard]] const FrameSamples<T>& samples() const noexcept { return dual_step_.samples(); }
  [[nodiscard]] SpareVectors<T> spare() noexcept {
    return {dual_step_.samples(), dual_step_.row_scratch(), gradient_, coefficients_, scratch_};
  }

  void delivered(const FrameInfo& info) noexcept {
    warm_start_.keep(dual_step_.samples(), info.health != Health::invalid);
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
      descend(gradient_ + at, descent_, threshold_, problem_.lo, problem_.hi, problem_.relaxation, x_ + at, ahead_ + at,
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

  void follow_last_step() noexcept {
    finite_ = all_finite(x_, n_) && all_finite(ahead_, n_);  // the projection would have turned NaN into a number
    const double size = static_cast<double>(dot(gradient_, gradient_, n_));
    const double moved = static_cast<double>(squared_distance(ahead_, gradient_, n_));  // 2 p - x from p
    moved_ = size > 0.0 ? square_root(moved / size) : 0.0;
    if (problem_.warm_start || problem_.measure_gap || problem_.point.iterations == 1) rise(ahead_);
  }

  void judge(FrameInfo& info) noexcept {
    const std::size_t rows = problem_.a.rows;
    const double of_dual = static_cast<double>(dot(row_dual_, row_dual_, rows));
    const double off = static_cast<double>(dot(dual_step_.last_step(), dual_step_.last_step(), rows));
    info.dual_residual = of_dual > 0.0 ? square_root(off / of_dual) : 0.0;
    const T* penalised = gradient_;
    if (sparse_basis_) {
      analyse(problem_.psi, gradient_, coefficients_, scratch_);
      penalised = coefficients_;
    }
    evaluate(dual_step_.samples(), gradient_, l1_penalty(problem_, penalised), dual_step_.row_scratch(), info);
    judge_by_gap(problem_, gap_, gap_.measure(dual_step_.samples(), gradient_, bounded_dual(), info.objective),
                 still_step, info);
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

  const PdhgProblem<T>& problem_;
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
  T descent_ = T(0);
  T threshold_ = T(0);
  Ascent<T> ascent_;
  bool warm_ = false;
  bool finite_ = true;
  double moved_ = 0.0;  // x by the last iteration, relative to the picture
};

}  // namespace

template <class T>
const Solver<T> PdhgProblem<T>::solver{&frame_bytes<T, PdhgProblem, Pdhg>, &solve_frame<T, PdhgProblem, Pdhg>,
                                       &WarmStart<T>::forget};
template struct PdhgProblem<float>;
template struct PdhgProblem<double>;

}  // namespace compueye::recon::core
