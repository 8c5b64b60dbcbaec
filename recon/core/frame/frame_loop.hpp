#pragma once

#include <type_traits>

#include "recon/core/frame/black_picture.hpp"
#include "recon/core/frame/frame_outcome.hpp"
#include "recon/core/frame/frame_problem.hpp"
#include "recon/core/parts/workspace.hpp"

namespace compueye::recon::core {

// A frame, once for all methods. A Method<T> is made from its problem and a Workspace, which it takes its vectors from,
// and has
//
//   bool begin(y, weights)    takes the samples, sets the iterates to their start; false: the frame cannot be solved
//   void iterate(k)           the k-th iteration of problem.point.iterations, from 1; or bool: false where it has
//                             come to an end by itself
//   bool finish(info)         leaves the answer in picture() and fills in what is known of it; false: it is not finite
//   const T* picture()        problem.pixels() values
//   samples()                 FrameSamples<T>, as begin() took them
//   SpareVectors<T> spare()   of a method that minimises the objective: what it works in, free once x is handed out
//   void delivered(info)      if there is one: comes last, when info is complete; not after a begin() that was false

/// What goes on after begin().
template <class Method>
void iterate_all(Method& method, int iterations) noexcept {
  for (int k = 1; k <= iterations; ++k) {
    if constexpr (std::is_same_v<decltype(method.iterate(k)), bool>) {
      if (!method.iterate(k)) return;
    } else {
      method.iterate(k);
    }
  }
}

template <class T, class Method>
FrameInfo run_frame(Method& method, const FrameProblem<T>& problem, const float* y, const float* weights,
                    float* x) noexcept {
  FrameInfo info;
  info.point = problem.point;
  if (!method.begin(y, weights)) {
    deliver(method.picture(), 1.0, false, problem.pixels(), info, x);
    return info;
  }
  const FrameUnit& unit = method.samples().unit();
  iterate_all(method, problem.point.iterations);
  const bool finite = method.finish(info);
  deliver(method.picture(), unit.picture, finite, problem.pixels(), info, x);
  constexpr bool minimises = requires {
    method.spare();
  };
  if constexpr (minimises) prefer_black(problem, method.spare(), info, x);
  unit.restore(info, minimises && problem.bounded);
  if constexpr (requires { method.delivered(info); }) method.delivered(info);
  return info;
}

/// A method whose members would fill a microcontroller's stack is MadeInWorkspace, and comes first there.
template <class Method>
inline constexpr bool in_workspace = std::is_base_of_v<MadeInWorkspace, Method>;

template <class T, template <class> class Problem, template <class> class Method>
FrameInfo solve_frame(const FrameProblem<T>& shared, const float* y, const float* weights, std::byte* workspace,
                      float* x) noexcept {
  const auto& problem = static_cast<const Problem<T>&>(shared);
  Workspace memory(workspace);
  if constexpr (in_workspace<Method<T>>) {
    auto* place = memory.take<Method<T>>(1);
    return run_frame(*new (place) Method<T>(problem, memory), shared, y, weights, x);
  } else {
    Method<T> method(problem, memory);
    return run_frame(method, shared, y, weights, x);
  }
}

template <class T, template <class> class Problem, template <class> class Method>
std::size_t frame_bytes(const FrameProblem<T>& shared) noexcept {
  Workspace counter;
  if constexpr (in_workspace<Method<T>>) static_cast<void>(counter.take<Method<T>>(1));
  const Method<T> method(static_cast<const Problem<T>&>(shared), counter);
  return counter.used();
}

/// The row that a method's file ends in.
template <class T, template <class> class Problem, template <class> class Method>
inline constexpr Solver<T> solver_of{&frame_bytes<T, Problem, Method>, &solve_frame<T, Problem, Method>, nullptr};

}  // namespace compueye::recon::core
