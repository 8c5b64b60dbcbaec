#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "recon/core/frame/frame_info.hpp"
#include "recon/core/parts/workspace.hpp"

namespace compueye::recon {

/// Huber's data term (Huber 1964, "Robust estimation of a location parameter") by frames with weights, which every
/// solver takes: h(r) = r^2 / 2 up to delta and delta (|r| - delta / 2) beyond. A channel whose residual r is beyond
/// delta weighs delta / |r| of what it did in the next pass (Holland & Welsch 1977, iteratively reweighted least
/// squares); no pass raises the objective, given the optimum of each.
class HuberPasses {
 public:
  /// A frame is solved up to this many times, fewer where the weights stand still.
  static constexpr int most = 8;
  static constexpr float still = 0.01F;  ///< of the larger of a channel's weights before and after
  /// Channels beyond delta that a frame of `seeing` channels is to have room for: a tenth, rounded up.
  [[nodiscard]] static constexpr int room(int seeing) noexcept { return (seeing + 9) / 10; }

  /// `delta` > 0, in units of y. `most_weighted`: Plan::max_reweighted. Made on a Workspace without memory it only
  /// counts.
  HuberPasses(double delta, int channels, int most_weighted, core::Workspace& memory) noexcept
      : delta_(delta),
        most_weighted_(static_cast<std::size_t>(most_weighted)),
        weights_(memory.take<float>(static_cast<std::size_t>(channels)), static_cast<std::size_t>(channels)),
        residuals_(memory.take<float>(weights_.size()), weights_.size()),
        sizes_(memory.take<float>(weights_.size()), weights_.size()) {}

  /// `solve(weights)` is one frame, `find(residuals)` fills in y - A x of its picture at every channel in use. `given`:
  /// the frame's own weights, empty: all one. The objective is Huber's; no gap is known of it.
  template <class Solve, class Find>
  FrameInfo run(std::span<const float> given, const Solve& solve, const Find& find) noexcept {
    FrameInfo info = solve(given);
    take(given);
    int iterations = info.iterations;
    bool settled = false;
    for (int pass = 1; info.health != Health::invalid; ++pass) {
      find(residuals_);
      settled = reweigh(given);
      if (settled || pass == most) break;
      info = solve(weights_);
      iterations += info.iterations;
    }
    info.iterations = iterations;
    info.duality_gap = -1.0;
    if (info.health == Health::invalid) return info;
    info.objective = objective_of(given, info);
    if (!settled) info.health = Health::budget_used;
    return info;
  }

 private:
  [[nodiscard]] float given_to(std::span<const float> given, std::size_t channel) const noexcept {
    return given.empty() ? 1.0F : given[channel];
  }
  void take(std::span<const float> given) noexcept;
  /// True when all weights stand still, and none that should be reduced is left for want of room.
  [[nodiscard]] bool reweigh(std::span<const float> given) noexcept;
  /// The residual beyond which a channel is weighed anew: delta, or what leaves no more of them than planned.
  [[nodiscard]] float least_outlier(std::span<const float> given) noexcept;
  /// Huber's, of what the last pass says.
  [[nodiscard]] double objective_of(std::span<const float> given, const FrameInfo& info) const noexcept;
  /// Sum of the data term.
  [[nodiscard]] double data_term(std::span<const float> given) const noexcept;

  double delta_;
  std::size_t most_weighted_;
  std::span<float> weights_, residuals_, sizes_;
};

}  // namespace compueye::recon
