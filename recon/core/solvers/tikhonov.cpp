#include "recon/core/solvers/tikhonov.hpp"

#include "recon/core/parts/frame_outcome.hpp"
#include "recon/core/parts/vector_sums.hpp"
#include "recon/core/parts/weighted_step.hpp"

namespace compueye::recon::core {

template <class T>
FrameInfo solve_tikhonov(const FrameProblem<T>& problem, const float* y, const float* weights, std::byte* workspace,
                         float* x) noexcept {
  Workspace memory(workspace);
  WeightedStep<T> step(problem, memory);
  T* solution = memory.take<T>(problem.pixels());
  FrameInfo info = begin_outcome(problem);
  const bool usable = step.begin(y, weights);
  if (usable) {
    for (std::size_t k = 0; k < problem.pixels(); ++k) solution[k] = T(0);
    step.apply(solution);
    info.health = Health::converged;
    info.iterations = 1;
    const double squared_norm = static_cast<double>(dot(solution, solution, problem.pixels()));
    evaluate(step.samples(), solution, 0.5 * static_cast<double>(problem.lambda) * squared_norm, step.row_scratch(),
             info);
  }
  deliver(solution, usable, problem.pixels(), info, x);
  return info;
}

template <class T>
std::size_t tikhonov_bytes(const FrameProblem<T>& problem) noexcept {
  Workspace counter;
  const WeightedStep<T> step(problem, counter);
  (void)counter.take<T>(problem.pixels());
  return counter.used();
}

template FrameInfo solve_tikhonov(const FrameProblem<float>&, const float*, const float*, std::byte*, float*) noexcept;
template FrameInfo solve_tikhonov(const FrameProblem<double>&, const float*, const float*, std::byte*, float*) noexcept;
template std::size_t tikhonov_bytes(const FrameProblem<float>&) noexcept;
template std::size_t tikhonov_bytes(const FrameProblem<double>&) noexcept;

}  // namespace compueye::recon::core
