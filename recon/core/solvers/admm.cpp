#include "recon/core/solvers/admm.hpp"

#include "recon/core/frame/duality_gap.hpp"
#include "recon/core/frame/frame_loop.hpp"
#include "recon/core/frame/frame_outcome.hpp"
#include "recon/core/frame/weighted_step.hpp"
#include "recon/core/parts/proximal.hpp"
#include "recon/core/parts/vector_sums.hpp"

namespace compueye::recon::core {
namespace {

constexpr double dwarfed = 16.0;

/// A copy z of x, or of Psi x, with its scaled dual u and its proximal map.
template <class T>
struct Copy {
  T* z = nullptr;
  T* u = nullptr;
  T threshold = T(0);
  const T* thresholds = nullptr;  // where set, one a variable in place of the common one
  T lo = T(0);
  T hi = T(0);

  void place(std::size_t n, Workspace& memory) noexcept {
    z = memory.take<T>(n);
    u = memory.take<T>(n);
  }

  void clear(std::size_t n) noexcept {
    for (std::size_t k = 0; k < n; ++k) z[k] = u[k] = T(0);
  }

  void update(const T* x, std::size_t n, T relaxation, const Crew& crew) noexcept {
    crew.share(n, n, [&](std::size_t, std::size_t begin, std::size_t end) {
      const std::size_t count = end - begin;
      if (thresholds == nullptr) {
        relaxed_prox_step(x + begin, z + begin, u + begin, count, relaxation, threshold, lo, hi);
      } else {
        relaxed_prox_step(x + begin, z + begin, u + begin, count, relaxation, thresholds + begin, lo, hi);
      }
    });
  }

  /// out = z - u
  void subtract_dual(T* out, std::size_t n, const Crew& crew) const noexcept {
    crew.share(n, n, [&](std::size_t, std::size_t begin, std::size_t end) {
      subtract(z + begin, u + begin, out + begin, end - begin);
    });
  }

  void update_and_measure(const T* x, T* before, std::size_t n, T relaxation, const Crew& crew,
                          SplitResiduals& residuals) noexcept {
    for (std::size_t k = 0; k < n; ++k) before[k] = z[k];
    update(x, n, relaxation, crew);
    residuals.add(x, z, before, u, n);
  }
};

template <class T>
class Admm : public MadeInWorkspace {
 public:
  Admm(const AdmmProblem<T>& problem, Workspace& memory) noexcept
      : problem_(problem),
        n_(problem.pixels()),
        step_(problem, memory),
        x_(memory.take<T>(n_)),
        sparse_basis_(problem.point.basis != BasisKind::identity),
        smooth_(!problem.metric.is_identity()),
        pixel_copy_(!sparse_basis_ || problem.constrained || smooth_),
        coefficient_count_(problem.psi.coefficients()),
        before_(memory.take<T>(coefficient_count_)),
        gap_(problem, problem.measure_gap && !reweights(), memory),
        samples_in_order_(memory.take<T>(problem.thin_step.sample_size())),
        residual_in_order_(memory.take<T>(problem.thin_step.sample_size())) {
    if (reweights()) thresholds_ = memory.take<T>(n_);
    if (sparse_basis_) {
      coefficients_ = memory.take<T>(coefficient_count_);
      scratch_ = memory.take<T>(problem.psi.scratch_size());
      in_basis_.place(coefficient_count_, memory);
    }
    if (pixel_copy_) in_pixels_.place(n_, memory);
    set_proximal_maps();
  }

  bool begin(const float* y, const float* weights) noexcept {
    if (!step_.begin(y, weights)) return false;
    clear();
    thin_ = problem_.thin_step.rows > 0 && step_.samples().channels_reweighted() == 0;
    if (thin_) turn_samples(problem_.thin_step, step_.samples().values(), samples_in_order_, residual_in_order_);
    penalty_ = problem_.rho;
    in_pixels_.thresholds = nullptr;
    if (reweights()) {
      for (int k = 0; k < problem_.point.iterations; ++k) meet_and_move(nullptr);
      reweight();
    }
    return true;
  }

  void iterate(int k) noexcept {
    if (thin_) follow_schedule(k - 1);
    meet_and_move(k == problem_.point.iterations ? &residuals_ : nullptr);
  }

  /// The copy that is feasible (pixels) or sparse (coefficients) is the answer, not the average they are drawn to.
  bool finish(FrameInfo& info) noexcept {
    const bool finite = all_finite(x_, n_);  // a clip would turn NaN into a number
    if (thin_) {
      restore_picture(problem_.thin_step, in_pixels_.z, x_);
    } else if (pixel_copy_) {
      for (std::size_t k = 0; k < n_; ++k) x_[k] = in_pixels_.z[k];
      if (sparse_basis_) analyse(problem_.psi, x_, coefficients_, scratch_);
    } else {
      synthesise(problem_.psi, in_basis_.z, x_, scratch_);
      for (std::size_t k = 0; k < n_; ++k) coefficients_[k] = in_basis_.z[k];
    }
    const T* penalised = sparse_basis_ ? coefficients_ : x_;
    const double penalty = reweights() ? weighted_penalty() : l1_penalty(problem_, penalised);
    evaluate(step_.samples(), x_, penalty, step_.row_scratch(), info);
    if (duals_dwarf_picture()) prefer_sparse_copy(info);
    residuals_.tell(info);
    const double gap = reweights() ? -1.0 : gap_.measure(step_.samples(), x_, basis_dual(), info.objective);
    judge_by_gap(problem_, gap_, gap, still_split, info);
    if (reweights()) info.iterations *= 2;
    return finite;
  }

  [[nodiscard]] const T* picture() const noexcept { return x_; }
  [[nodiscard]] const FrameSamples<T>& samples() const noexcept { return step_.samples(); }
  [[nodiscard]] SpareVectors<T> spare() noexcept {
    return {step_.samples(), step_.row_scratch(), x_, coefficients_, scratch_};
  }

 private:
  /// A dual of lambda / rho leaves its rounding in every pixel, and so in every coefficient that should be zero.
  [[nodiscard]] bool duals_dwarf_picture() const noexcept {
    if (!sparse_basis_ || !problem_.constrained || smooth_) return false;
    T largest = T(0);
    for (std::size_t k = 0; k < n_; ++k) {
      const T size = x_[k] < T(0) ? -x_[k] : x_[k];
      if (size > largest) largest = size;
    }
    return in_basis_.threshold > static_cast<T>(dwarfed) * largest;
  }

  /// The copy whose zeros are zeros, with its pixels brought back within the constraint, where its objective is lower.
  void prefer_sparse_copy(FrameInfo& info) noexcept {
    synthesise(problem_.psi, in_basis_.z, before_, scratch_);
    for (std::size_t k = 0; k < n_; ++k) before_[k] = prox_l1_box(before_[k], T(0), problem_.lo, problem_.hi);
    analyse(problem_.psi, before_, coefficients_, scratch_);
    const double objective = info.objective, residual = info.residual;
    evaluate(step_.samples(), before_, l1_penalty(problem_, coefficients_), step_.row_scratch(), info);
    if (info.objective < objective) {
      for (std::size_t k = 0; k < n_; ++k) x_[k] = before_[k];
    } else {
      info.objective = objective;
      info.residual = residual;
    }
  }

  [[nodiscard]] bool reweights() const noexcept { return problem_.l1_reweighting > T(0); }

  /// Pixels that the first pass found lit are shrunk little in the second, dark ones twice as much as before.
  void reweight() noexcept {
    const T e = problem_.l1_reweighting, twice = T(2) * in_pixels_.threshold;
    for (std::size_t k = 0; k < n_; ++k) {
      const T z = in_pixels_.z[k];
      thresholds_[k] = twice * e / ((z < T(0) ? -z : z) + e);
    }
    in_pixels_.thresholds = thresholds_;
  }

  /// rho times the sum of threshold times magnitude: lambda ||w x||_1.
  [[nodiscard]] double weighted_penalty() const noexcept {
    double sum = 0.0;
    for (std::size_t k = 0; k < n_; ++k) {
      const T z = in_pixels_.z[k];
      sum += static_cast<double>(thresholds_[k]) * static_cast<double>(z < T(0) ? -z : z);
    }
    return static_cast<double>(problem_.rho) * sum;
  }

  void set_proximal_maps() noexcept {
    const bool shared = sparse_basis_ && pixel_copy_ && !smooth_;
    const T penalty = shared ? problem_.rho * T(0.5) : problem_.rho;
    in_basis_.threshold = problem_.lambda / penalty;
    in_basis_.lo = T(-no_bound);
    in_basis_.hi = T(no_bound);
    in_pixels_.threshold = sparse_basis_ ? T(0) : in_basis_.threshold;
    in_pixels_.lo = problem_.lo;
    in_pixels_.hi = problem_.hi;
  }

  void clear() noexcept {
    if (sparse_basis_) in_basis_.clear(coefficient_count_);
    if (pixel_copy_) in_pixels_.clear(n_);
  }

  /// The dual that u scales stays what it is.
  void follow_schedule(int done) noexcept {
    level_ = problem_.schedule.level(static_cast<std::size_t>(done));
    const T penalty = problem_.schedule.penalty[level_];
    if (penalty == penalty_) return;
    const T scale = penalty_ / penalty;
    penalty_ = penalty;
    in_pixels_.threshold = problem_.lambda / penalty;
    if (done == 0) return;
    for (std::size_t k = 0; k < n_; ++k) in_pixels_.u[k] *= scale;
  }

  void meet_and_move(SplitResiduals* residuals) noexcept {
    meet();
    if (thin_) {
      apply(problem_.thin_step, level_, samples_in_order_, x_, residual_in_order_);
    } else {
      step_.apply(x_);
    }
    if (sparse_basis_) {
      analyse(problem_.psi, x_, coefficients_, scratch_);
      move(in_basis_, coefficients_, coefficient_count_, residuals);
    }
    if (pixel_copy_) move(in_pixels_, x_, n_, residuals);
  }

  /// x_ = the point the copies pull to: K0^-1 (Psi' (z - u) + (z - u)) or their average, or the only one.
  void meet() noexcept {
    if (!sparse_basis_) return in_pixels_.subtract_dual(x_, n_, problem_.crew);
    in_basis_.subtract_dual(coefficients_, coefficient_count_, problem_.crew);
    synthesise(problem_.psi, coefficients_, x_, scratch_);
    if (smooth_) {
      for (std::size_t k = 0; k < n_; ++k) x_[k] += in_pixels_.z[k] - in_pixels_.u[k];
      apply_inverse(problem_.metric, x_, coefficients_, scratch_);
    } else if (pixel_copy_) {
      problem_.crew.share(n_, n_, [&](std::size_t, std::size_t begin, std::size_t end) {
        blend_difference(in_pixels_.z + begin, in_pixels_.u + begin, T(0.5), x_ + begin, end - begin);
      });
    }
  }

  void move(Copy<T>& copy, const T* x, std::size_t n, SplitResiduals* residuals) noexcept {
    if (residuals == nullptr) {
      copy.update(x, n, problem_.relaxation, problem_.crew);
    } else {
      copy.update_and_measure(x, before_, n, problem_.relaxation, problem_.crew, *residuals);
    }
  }

  /// Unscaled, where what the coefficients were is no longer needed.
  const T* basis_dual() noexcept {
    if (!sparse_basis_ || !problem_.measure_gap) return nullptr;
    const T penalty = in_basis_.threshold > T(0) ? problem_.lambda / in_basis_.threshold : T(0);
    for (std::size_t k = 0; k < coefficient_count_; ++k) coefficients_[k] = penalty * in_basis_.u[k];
    return coefficients_;
  }

  const AdmmProblem<T>& problem_;
  std::size_t n_;
  WeightedStep<T> step_;
  T* x_;
  bool sparse_basis_;
  bool smooth_;
  bool pixel_copy_;
  std::size_t coefficient_count_;
  T* before_;
  DualityGap<T> gap_;
  T* samples_in_order_;
  T* residual_in_order_;
  bool thin_ = false;
  std::size_t level_ = 0;
  T penalty_ = T(1);
  T* thresholds_ = nullptr;
  T* coefficients_ = nullptr;
  T* scratch_ = nullptr;
  Copy<T> in_basis_;
  Copy<T> in_pixels_;
  SplitResiduals residuals_;  // of the last iteration
};

}  // namespace

template <class T>
const Solver<T> AdmmProblem<T>::solver = solver_of<T, AdmmProblem, Admm>;
template struct AdmmProblem<float>;
template struct AdmmProblem<double>;

}  // namespace compueye::recon::core
