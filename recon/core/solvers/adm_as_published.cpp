#include "recon/core/solvers/adm_as_published.hpp"

#include "recon/core/frame/duality_gap.hpp"
#include "recon/core/frame/frame_loop.hpp"
#include "recon/core/parts/square_root.hpp"
#include "recon/core/parts/vector_sums.hpp"

namespace compueye::recon::core {
namespace {

constexpr double tolerance = 1e-4;
constexpr double least_penalty = 2.220446049250313e-16;  // what stands for lambda = 0 in the original

template <class T>
class PublishedAdm {
 public:
  PublishedAdm(const PublishedAdmProblem<T>& problem, Workspace& memory) noexcept
      : problem_(problem),
        rows_(problem.a.rows),
        n_(problem.pixels()),
        samples_(problem, memory),
        b_(memory.take<T>(rows_)),
        y_(memory.take<T>(rows_)),
        row_residual_(memory.take<T>(rows_)),
        row_scratch_(memory.take<T>(rows_)),
        x_(memory.take<T>(n_)),
        z_(memory.take<T>(n_)),
        back_(memory.take<T>(n_)),
        step_back_(memory.take<T>(n_)),
        picture_(memory.take<T>(n_)),
        scratch_(memory.take<T>(problem.psi.scratch_size())),
        gap_(problem, problem.measure_gap, memory) {}

  bool begin(const float* y, const float* weights) noexcept {
    if (!samples_.gather(y, weights)) return false;
    done_ = 0;
    stopped_ = !scale_data();
    return true;
  }

  bool iterate(int k) noexcept {
    if (stopped_) return false;
    const double moved = step();
    done_ = k;
    stopped_ = k % 2 == 0 && stops(moved);
    return !stopped_;
  }

  bool finish(FrameInfo& info) noexcept {
    for (std::size_t k = 0; k < n_; ++k) x_[k] *= scale_;
    if (problem_.constrained) {
      for (std::size_t k = 0; k < n_; ++k) x_[k] = x_[k] > T(0) ? x_[k] : T(0);
    }
    synthesise(problem_.psi, x_, picture_, scratch_);
    evaluate(samples_, picture_, l1_penalty(problem_, x_), row_scratch_, info);
    if (problem_.bounded) info.objective = static_cast<double>(sum_of_magnitudes(x_, n_));
    info.duality_gap = gap_.measure(samples_, picture_, nullptr, info.objective);
    info.iterations = done_;
    info.health = stopped_ ? Health::converged : Health::budget_used;
    return all_finite(x_, n_);
  }

  [[nodiscard]] const T* picture() const noexcept { return picture_; }
  [[nodiscard]] const FrameSamples<T>& samples() const noexcept { return samples_; }

 private:
  /// out = W^(1/2) A Psi' in
  void apply(const T* in, T* out) noexcept {
    synthesise(problem_.psi, in, picture_, scratch_);
    samples_.forward(picture_, out);
    for (std::size_t i = 0; i < rows_; ++i) out[i] *= root_weight(i);
  }

  /// out = Psi A' W^(1/2) in
  void apply_adjoint(const T* in, T* out) noexcept {
    for (std::size_t i = 0; i < rows_; ++i) row_scratch_[i] = in[i] * root_weight(i);
    for (std::size_t k = 0; k < n_; ++k) picture_[k] = T(0);
    samples_.adjoint_accumulate(row_scratch_, picture_);
    analyse(problem_.psi, picture_, out, scratch_);
  }

  [[nodiscard]] T root_weight(std::size_t i) const noexcept {
    return static_cast<T>(square_root(static_cast<double>(samples_.weights()[i])));
  }

  /// Scales the data as the original does. False when it would return x = 0 without an iteration.
  bool scale_data() noexcept {
    double largest = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < rows_; ++i) {
      b_[i] = root_weight(i) * samples_.values()[i];
      const double size = static_cast<double>(b_[i] < T(0) ? -b_[i] : b_[i]);
      if (size > largest) largest = size;
      squares += size * size;
    }
    apply_adjoint(b_, x_);
    double correlation = 0.0;
    for (std::size_t k = 0; k < n_; ++k) {
      const double size = static_cast<double>(x_[k] < T(0) ? -x_[k] : x_[k]);
      if (size > correlation) correlation = size;
    }
    const double lambda = problem_.bounded ? 0.0 : static_cast<double>(problem_.lambda);
    const bool within = problem_.bounded && square_root(squares) <= static_cast<double>(problem_.epsilon);
    if (within || correlation <= lambda || !(largest > 0.0)) {
      for (std::size_t k = 0; k < n_; ++k) x_[k] = T(0);
      scale_ = T(1);
      return false;
    }
    scale_ = static_cast<T>(largest);
    lambda_ = static_cast<T>(lambda > 0.0 ? lambda / largest : least_penalty);
    epsilon_ = problem_.bounded ? static_cast<double>(problem_.epsilon) / largest : 0.0;
    double mean = 0.0;
    for (std::size_t i = 0; i < rows_; ++i) {
      b_[i] /= scale_;
      y_[i] = T(0);
      mean += static_cast<double>(b_[i] < T(0) ? -b_[i] : b_[i]);
    }
    penalty_ = static_cast<T>(mean / static_cast<double>(rows_));
    for (std::size_t k = 0; k < n_; ++k) {
      x_[k] /= scale_;
      z_[k] = back_[k] = T(0);
    }
    return true;
  }

  /// One steepest descent step for y, the projection of z, the multiplier step for x; returns ||x - x before||^2.
  double step() noexcept {
    for (std::size_t k = 0; k < n_; ++k) step_back_[k] = back_[k] - z_[k] + x_[k] / penalty_;
    apply(step_back_, row_residual_);
    const T ratio = lambda_ / penalty_;
    for (std::size_t i = 0; i < rows_; ++i) row_residual_[i] += ratio * y_[i] - b_[i] / penalty_;
    apply_adjoint(row_residual_, step_back_);
    const double size = static_cast<double>(dot(row_residual_, row_residual_, rows_));
    const double curvature = static_cast<double>(dot(step_back_, step_back_, n_)) + static_cast<double>(ratio) * size;
    const T length = static_cast<T>(size / (curvature + least_penalty));
    for (std::size_t i = 0; i < rows_; ++i) y_[i] -= length * row_residual_[i];
    double moved = 0.0;
    for (std::size_t k = 0; k < n_; ++k) {
      back_[k] -= length * step_back_[k];
      const T z = back_[k] + x_[k] / penalty_;
      const T above = problem_.constrained || z > T(-1) ? z : T(-1);
      z_[k] = above < T(1) ? above : T(1);
      const T before = x_[k];
      x_[k] += penalty_ * (back_[k] - z_[k]);
      const double by = static_cast<double>(x_[k]) - static_cast<double>(before);
      moved += by * by;
    }
    return moved;
  }

  /// Comparisons with NaN (x exactly zero) are false, as in the original.
  [[nodiscard]] bool stops(double moved) noexcept {
    const double share = problem_.bounded ? 0.0 : 0.1;
    const double change = square_root(moved) / square_root(static_cast<double>(dot(x_, x_, n_)));
    if (change < tolerance * (1.0 - share)) return true;
    if (change >= tolerance * (1.0 + share)) return false;
    apply(x_, row_residual_);
    double squared = 0.0, linear = 0.0;
    for (std::size_t i = 0; i < rows_; ++i) {
      const double r = static_cast<double>(row_residual_[i] - b_[i]);
      squared += r * r;
      linear += static_cast<double>(b_[i]) * static_cast<double>(y_[i]);
    }
    const double lambda = static_cast<double>(lambda_), y_y = static_cast<double>(dot(y_, y_, rows_));
    const double primal = static_cast<double>(sum_of_magnitudes(x_, n_)) + 0.5 / lambda * squared;
    const double dual = linear - epsilon_ * square_root(y_y) - 0.5 * lambda * y_y;
    const double gap = dual > primal ? dual - primal : primal - dual;
    if (!(gap / primal < tolerance)) return false;
    const double apart = static_cast<double>(squared_distance(back_, z_, n_));
    return square_root(apart) / square_root(static_cast<double>(dot(z_, z_, n_))) < tolerance;
  }

  const PublishedAdmProblem<T>& problem_;
  std::size_t rows_;
  std::size_t n_;
  FrameSamples<T> samples_;
  T* b_;  // W^(1/2) y, scaled
  T* y_;  // the dual variable
  T* row_residual_;
  T* row_scratch_;
  T* x_;
  T* z_;
  T* back_;  // Psi A' W^(1/2) y
  T* step_back_;
  T* picture_;
  T* scratch_;
  DualityGap<T> gap_;
  T scale_ = T(1);
  T lambda_ = T(0);
  T penalty_ = T(1);
  double epsilon_ = 0.0;
  int done_ = 0;
  bool stopped_ = false;  // by itself
};

}  // namespace

template <class T>
const Solver<T> PublishedAdmProblem<T>::solver = solver_of<T, PublishedAdmProblem, PublishedAdm>;
template struct PublishedAdmProblem<float>;
template struct PublishedAdmProblem<double>;

}  // namespace compueye::recon::core
