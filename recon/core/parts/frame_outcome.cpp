#include "recon/core/parts/frame_outcome.hpp"

#include "recon/core/parts/square_root.hpp"
#include "recon/core/parts/vector_sums.hpp"

namespace compueye::recon::core {

template <class T>
FrameInfo begin_outcome(const FrameProblem<T>& problem) noexcept {
  FrameInfo info;
  info.point = problem.point;
  return info;
}

template <class T>
void deliver(const T* solution, bool usable, std::size_t n, FrameInfo& info, float* x) noexcept {
  // A float32 x may overflow where a double solution did not; objectives overflow before either.
  for (std::size_t k = 0; k < n; ++k) x[k] = usable ? static_cast<float>(solution[k]) : 0.0F;
  if (usable && all_finite(x, n) && all_finite(&info.objective, 1)) return;
  for (std::size_t k = 0; k < n; ++k) x[k] = 0.0F;
  info.health = Health::invalid;
  info.objective = info.residual = info.primal_residual = info.dual_residual = 0.0;
}

template <class T>
void evaluate(const FrameSamples<T>& samples, const T* solution, double penalty, T* scratch, FrameInfo& info) noexcept {
  const double squared = samples.squared_residual(solution, scratch);
  info.residual = square_root(squared);
  info.objective = 0.5 * squared + penalty;
  info.channels_used = static_cast<int>(samples.channels_used());
  info.channels_reweighted = static_cast<int>(samples.channels_reweighted());
}

template FrameInfo begin_outcome(const FrameProblem<float>&) noexcept;
template FrameInfo begin_outcome(const FrameProblem<double>&) noexcept;
template void deliver(const float*, bool, std::size_t, FrameInfo&, float*) noexcept;
template void deliver(const double*, bool, std::size_t, FrameInfo&, float*) noexcept;
template void evaluate(const FrameSamples<float>&, const float*, double, float*, FrameInfo&) noexcept;
template void evaluate(const FrameSamples<double>&, const double*, double, double*, FrameInfo&) noexcept;

}  // namespace compueye::recon::core
