#include "recon/core/frame/least_residual.hpp"

#include "recon/core/frame/frame_samples.hpp"
#include "recon/core/parts/square_root.hpp"

namespace compueye::recon::core {
namespace {

template <class T>
struct Memory {
  Memory(const FrameProblem<T>& problem, Workspace& workspace) noexcept
      : samples(problem, workspace),
        residual(workspace.take<T>(problem.a.rows)),
        picture(workspace.take<T>(problem.pixels())) {}

  FrameSamples<T> samples;
  T* residual;
  T* picture;  // x, and then A'W r
};

struct PictureRange {
  double lo = 0.0, hi = 1.0;
};

template <class T>
PictureRange take_picture(const float* x, std::size_t n, double unit, T* picture) noexcept {
  PictureRange range;
  for (std::size_t k = 0; k < n; ++k) {
    const auto value = static_cast<double>(x[k]);
    range.lo = value < range.lo ? value : range.lo;
    range.hi = value > range.hi ? value : range.hi;
    picture[k] = static_cast<T>(value / unit);
  }
  return {range.lo / unit, range.hi / unit};
}

template <class T>
double most_of(const T* slopes, std::size_t n, PictureRange range) noexcept {
  double sum = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    const auto slope = static_cast<double>(slopes[k]);
    sum += slope * (slope > 0.0 ? range.hi : range.lo);
  }
  return sum;
}

}  // namespace

template <class T>
LeastResidual least_residual(const FrameProblem<T>& problem, const float* y, const float* weights, const float* x,
                             std::byte* workspace) noexcept {
  Workspace room(workspace);
  Memory<T> memory(problem, room);
  if (!memory.samples.gather(y, weights)) return {};
  const FrameUnit& unit = memory.samples.unit();
  const PictureRange range = take_picture(x, problem.pixels(), unit.picture, memory.picture);
  memory.samples.residual(memory.picture, memory.residual);
  double of_residual = 0.0, of_samples = 0.0, product = 0.0;
  for (std::size_t i = 0; i < problem.a.rows; ++i) {
    const auto weight = static_cast<double>(memory.samples.weights()[i]);
    const auto r = static_cast<double>(memory.residual[i]), sample = static_cast<double>(memory.samples.values()[i]);
    of_residual += weight * r * r;
    of_samples += weight * sample * sample;
    product += weight * r * sample;
    memory.residual[i] *= memory.samples.weights()[i];
  }
  const LeastResidual nothing{0.0, square_root(of_samples) / unit.samples};
  if (!(of_residual > 0.0)) return nothing;
  for (std::size_t k = 0; k < problem.pixels(); ++k) memory.picture[k] = T(0);
  memory.samples.adjoint_accumulate(memory.residual, memory.picture);
  const double least =
      (product - most_of(memory.picture, problem.pixels(), range)) / (square_root(of_residual) * unit.samples);
  return least > 0.0 ? LeastResidual{least, nothing.samples} : nothing;
}

template <class T>
void channel_residuals(const FrameProblem<T>& problem, const float* y, const float* weights, const float* x,
                       std::byte* workspace, float* residuals) noexcept {
  Workspace room(workspace);
  Memory<T> memory(problem, room);
  for (std::size_t c = 0; c < problem.channels; ++c) residuals[c] = 0.0F;
  if (!memory.samples.gather(y, weights)) return;
  const FrameUnit& unit = memory.samples.unit();
  static_cast<void>(take_picture(x, problem.pixels(), unit.picture, memory.picture));
  memory.samples.residual(memory.picture, memory.residual);
  for (std::size_t i = 0; i < problem.a.rows; ++i) {
    residuals[static_cast<std::size_t>(problem.seeing[i])] =
        static_cast<float>(static_cast<double>(memory.residual[i]) / unit.samples);
  }
}

template <class T>
std::size_t least_residual_bytes(const FrameProblem<T>& problem) noexcept {
  Workspace counter;
  static_cast<void>(Memory<T>(problem, counter));
  return counter.used();
}

template LeastResidual least_residual(const FrameProblem<float>&, const float*, const float*, const float*,
                                      std::byte*) noexcept;
template LeastResidual least_residual(const FrameProblem<double>&, const float*, const float*, const float*,
                                      std::byte*) noexcept;
template void channel_residuals(const FrameProblem<float>&, const float*, const float*, const float*, std::byte*,
                                float*) noexcept;
template void channel_residuals(const FrameProblem<double>&, const float*, const float*, const float*, std::byte*,
                                float*) noexcept;
template std::size_t least_residual_bytes(const FrameProblem<float>&) noexcept;
template std::size_t least_residual_bytes(const FrameProblem<double>&) noexcept;

}  // namespace compueye::recon::core
