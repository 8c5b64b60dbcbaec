#include "recon/core/solvers/adm.hpp"

#include "recon/core/frame/duality_gap.hpp"
#include "recon/core/frame/frame_loop.hpp"
#include "recon/core/frame/frame_outcome.hpp"
#include "recon/core/frame/residual_copy.hpp"
#include "recon/core/frame/weighted_step.hpp"
#include "recon/core/parts/proximal.hpp"
#include "recon/core/parts/square_root.hpp"
#include "recon/core/parts/vector_sums.hpp"

namespace compueye::recon::core {
namespace {

/// Step of the multiplier: convergence is proven below (1 + sqrt 5) / 2 (Glowinski 1984).
constexpr double multiplier_step = 1.618;
constexpr double bound_tolerance = 1e-3;
/// Thresholds as shares of the mean brightness. On an 80x80 eye .03 still converges in tens of iterations.
constexpr double crawling = 0.02;
constexpr double most_threshold = 10.0;

template <class T>
class Adm {
 public:
  Adm(const AdmProblem<T>& problem, Workspace& memory) noexcept
      : problem_(problem),
        n_(problem.pixels()),
        step_(problem, memory),
        residual_(problem, memory),
        x_(memory.take<T>(n_)),
        pull_(memory.take<T>(n_)),
        sparse_(memory.take<T>(n_)),
        point_(memory.take<T>(n_)),
        before_(memory.take<T>(n_)),
        coefficients_(memory.take<T>(n_)),
        scratch_(memory.take<T>(problem.psi.scratch_size())),
        gap_(problem, problem.measure_gap, memory) {}

  bool begin(const float* y, const float* weights) noexcept {
    if (!step_.begin(y, weights)) return false;
    for (std::size_t k = 0; k < n_; ++k) x_[k] = pull_[k] = sparse_[k] = T(0);
    choose_threshold();
    return true;
  }

  /// pull is A'u over the penalty, sparse the proximal point of x + pull; what the step makes of sparse - pull is the
  /// next multiplier at a step of one.
  void iterate(int) noexcept {
    for (std::size_t k = 0; k < n_; ++k) before_[k] = sparse_[k];
    for (std::size_t k = 0; k < n_; ++k) point_[k] = x_[k] + pull_[k];
    shrink(point_);
    subtract(sparse_, pull_, point_, n_);
    step_.apply(point_, apart_ ? residual_.shift() : nullptr);
    const T step = static_cast<T>(multiplier_step);
    if (apart_) residual_.update(step_.correction(), step);
    for (std::size_t k = 0; k < n_; ++k) {
      pull_[k] += point_[k] - sparse_[k];
      x_[k] += step * (point_[k] - x_[k]);
    }
    flush_tiny(pull_, n_);
    flush_tiny(x_, n_);
  }

  bool finish(FrameInfo& info) noexcept {
    analyse(problem_.psi, sparse_, coefficients_, scratch_);
    const double magnitudes = static_cast<double>(sum_of_magnitudes(coefficients_, n_));
    const double penalty = problem_.bounded ? magnitudes : static_cast<double>(problem_.lambda) * magnitudes;
    evaluate(step_.samples(), sparse_, penalty, step_.row_scratch(), info);
    if (problem_.bounded) info.objective = penalty;
    SplitResiduals residuals;
    residuals.add(point_, sparse_, before_, pull_, n_);
    residuals.tell(info);
    judge_by_gap(problem_, gap_, gap_.measure(step_.samples(), sparse_, nullptr, info.objective), still_split, info);
    const double most = static_cast<double>(problem_.epsilon) * (1.0 + bound_tolerance);
    if (problem_.bounded && !(info.residual <= most)) info.health = Health::budget_used;
    return all_finite(x_, n_);  // a clip would have turned NaN into a number
  }

  [[nodiscard]] const T* picture() const noexcept { return sparse_; }
  [[nodiscard]] const FrameSamples<T>& samples() const noexcept { return step_.samples(); }
  [[nodiscard]] SpareVectors<T> spare() noexcept {
    return {step_.samples(), step_.row_scratch(), point_, coefficients_, scratch_};
  }

 private:
  /// Mean brightness of the picture, by what the channels read and what they would read from white.
  double mean_brightness() noexcept {
    const FrameSamples<T>& samples = step_.samples();
    double read = 0.0, weights = 0.0;
    for (std::size_t i = 0; i < problem_.a.rows; ++i) {
      const double weight = static_cast<double>(samples.weights()[i]), y = static_cast<double>(samples.values()[i]);
      read += weight * (y < 0.0 ? -y : y);
      weights += weight;
    }
    return weights > 0.0 ? read / (weights * static_cast<double>(problem_.mean_row_sum)) : 0.0;
  }

  /// x moves by about a threshold an iteration, so one far below the picture's brightness would crawl. Where
  /// lambda / rho is that small, or an epsilon takes lambda's place, the residual becomes a variable of its own and the
  /// threshold is free: for an epsilon half of what lambda / rho would be for a lambda as large as the noise that it
  /// allows times the norm of a column, within sight of the brightness.
  void choose_threshold() noexcept {
    const double bright = mean_brightness(), rho = static_cast<double>(problem_.rho);
    const double lambda = static_cast<double>(problem_.lambda);
    double wanted = lambda / rho;
    if (problem_.bounded) {
      const std::size_t used = step_.samples().channels_used();
      const double channels = used > 0 ? static_cast<double>(used) : 1.0;
      wanted = 0.5 * static_cast<double>(problem_.epsilon) / square_root(channels) *
               static_cast<double>(problem_.column_norm) / rho;
      const double most = most_threshold * bright;
      if (wanted > most) wanted = most;
    }
    apart_ = problem_.bounded || (lambda > 0.0 && wanted < crawling * bright);
    if (apart_ && wanted < bright) wanted = bright;
    if (problem_.bounded && !(wanted > 0.0)) wanted = 1.0;  // nothing to see
    threshold_ = static_cast<T>(wanted);
    if (apart_) residual_.begin(step_.samples(), lambda > 0.0 ? static_cast<T>(wanted * rho / lambda) : T(1));
  }

  void shrink(const T* from) noexcept {
    const bool pixels = problem_.psi.kind == BasisKind::identity;
    if (!pixels) analyse(problem_.psi, from, coefficients_, scratch_);
    const T* in = pixels ? from : coefficients_;
    T* out = pixels ? sparse_ : coefficients_;
    for (std::size_t k = 0; k < n_; ++k) out[k] = prox_l1_box(in[k], threshold_, problem_.lo, problem_.hi);
    flush_tiny(out, n_);
    if (!pixels) synthesise(problem_.psi, coefficients_, sparse_, scratch_);
  }

  const AdmProblem<T>& problem_;
  std::size_t n_;
  WeightedStep<T> step_;
  ResidualCopy<T> residual_;
  T* x_;       // the multiplier
  T* pull_;    // A'u / penalty
  T* sparse_;  // proximal point
  T* point_;   // where the quadratic step begins, then what it gives
  T* before_;  // sparse of the iteration before
  T* coefficients_;
  T* scratch_;
  DualityGap<T> gap_;
  bool apart_ = false;  // the residual is a variable of its own
  T threshold_ = T(0);
};

}  // namespace

template <class T>
const Solver<T> AdmProblem<T>::solver = solver_of<T, AdmProblem, Adm>;
template struct AdmProblem<float>;
template struct AdmProblem<double>;

}  // namespace compueye::recon::core
