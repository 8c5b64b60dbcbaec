#include "recon/core/solvers/tikhonov.hpp"

#include "recon/core/frame/frame_loop.hpp"
#include "recon/core/frame/weighted_step.hpp"
#include "recon/core/parts/vector_sums.hpp"

namespace compueye::recon::core {
namespace {

template <class T>
class Tikhonov {
 public:
  Tikhonov(const TikhonovProblem<T>& problem, Workspace& memory) noexcept
      : problem_(problem), step_(problem, memory), solution_(memory.take<T>(problem.pixels())) {}

  bool begin(const float* y, const float* weights) noexcept { return step_.begin(y, weights); }

  void iterate(int) noexcept {
    for (std::size_t k = 0; k < problem_.pixels(); ++k) solution_[k] = T(0);
    step_.apply(solution_);
  }

  bool finish(FrameInfo& info) noexcept {
    info.health = Health::converged;
    info.iterations = 1;
    const double squared_norm = static_cast<double>(dot(solution_, solution_, problem_.pixels()));
    evaluate(step_.samples(), solution_, 0.5 * static_cast<double>(problem_.lambda) * squared_norm, step_.row_scratch(),
             info);
    return true;
  }

  [[nodiscard]] const T* picture() const noexcept { return solution_; }

 private:
  const TikhonovProblem<T>& problem_;
  WeightedStep<T> step_;
  T* solution_;
};

}  // namespace

template <class T>
const Solver<T> TikhonovProblem<T>::solver = solver_of<T, TikhonovProblem, Tikhonov>;
template struct TikhonovProblem<float>;
template struct TikhonovProblem<double>;

}  // namespace compueye::recon::core
