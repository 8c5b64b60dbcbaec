#include "recon/core/solvers/tikhonov.hpp"

#include "recon/core/frame/frame_loop.hpp"
#include "recon/core/frame/weighted_step.hpp"
#include "recon/core/parts/vector_sums.hpp"

namespace compueye::recon::core {
namespace {

constexpr double most_gap = 1e-3;  // of the objective
constexpr int most_refined = 6;

template <class T>
class Tikhonov {
 public:
  Tikhonov(const TikhonovProblem<T>& problem, Workspace& memory) noexcept
      : problem_(problem),
        step_(problem, memory),
        solution_(memory.take<T>(problem.pixels())),
        pull_(memory.take<T>(problem.pixels())) {}

  bool begin(const float* y, const float* weights) noexcept { return step_.begin(y, weights); }

  void iterate(int) noexcept { solve(); }

  bool finish(FrameInfo& info) noexcept {
    info.iterations = 1;
    for (int refined = 0;; ++refined) {
      judge(info);
      if (info.health == Health::converged || refined == most_refined) return true;
      solve();
    }
  }

  [[nodiscard]] const T* picture() const noexcept { return solution_; }
  [[nodiscard]] const FrameSamples<T>& samples() const noexcept { return step_.samples(); }

 private:
  /// Once more is a step of iterative refinement.
  void solve() noexcept {
    for (std::size_t k = 0; k < problem_.pixels(); ++k) solution_[k] = T(0);
    step_.apply(solution_);
  }

  void judge(FrameInfo& info) noexcept {
    const double squared_norm = static_cast<double>(dot(solution_, solution_, problem_.pixels()));
    evaluate(step_.samples(), solution_, 0.5 * static_cast<double>(problem_.lambda) * squared_norm, step_.row_scratch(),
             info);
    info.health = gap() <= most_gap * info.objective ? Health::converged : Health::budget_used;
  }

  /// ||A'W (y - A x) - lambda x||^2 / (2 lambda), the duality gap at the dual u = W (y - A x): what rounding in the
  /// inverse has left of the picture.
  [[nodiscard]] double gap() noexcept {
    const FrameSamples<T>& samples = step_.samples();
    T* residual = step_.row_scratch();
    samples.residual(solution_, residual);
    for (std::size_t i = 0; i < problem_.a.rows; ++i) residual[i] *= samples.weights()[i];
    for (std::size_t k = 0; k < problem_.pixels(); ++k) pull_[k] = -problem_.lambda * solution_[k];
    samples.adjoint_accumulate(residual, pull_);
    return static_cast<double>(dot(pull_, pull_, problem_.pixels())) / (2.0 * static_cast<double>(problem_.lambda));
  }

  const TikhonovProblem<T>& problem_;
  WeightedStep<T> step_;
  T* solution_;
  T* pull_;
};

}  // namespace

template <class T>
const Solver<T> TikhonovProblem<T>::solver = solver_of<T, TikhonovProblem, Tikhonov>;
template struct TikhonovProblem<float>;
template struct TikhonovProblem<double>;

}  // namespace compueye::recon::core
