#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "hal/result.hpp"
#include "sim/effects/effect.hpp"
#include "sim/plan/sensitivity.hpp"
#include "sim/render/render_watch.hpp"

namespace compueye::sim {

enum class Decision {
  on,          ///< called for, and too large to be left out
  left_out,    ///< called for, and small enough
  not_called,  ///< nothing of the scene or the board calls for it
  forced_on,
  forced_off,
};

[[nodiscard]] std::string_view name(Decision decision) noexcept;

struct PlannedEffect {
  const Effect* effect = nullptr;
  std::string called_for_by;  ///< empty: by nothing
  double bound_lsb = 0.0;     ///< rms of what leaving it out changes at most; 0 when nothing calls for it
  double nmse = 0.0;          ///< what that adds to the reconstruction's NMSE at most: kappa (bound / rms of samples)^2
  EffectCost cost;
  Decision decision = Decision::not_called;

  [[nodiscard]] bool on() const noexcept { return decision == Decision::on || decision == Decision::forced_on; }
};

/// Which effects a scene before a board gets, and why.
struct Plan {
  std::vector<PlannedEffect> effects;  ///< all there are, in the order of light
  double signal_rms_lsb = 0.0;         ///< of the levels without noise, about
  double noise_lsb = 0.0;   ///< read noise, shot noise, rounding, as far as they are simulated: rms over the channels
  double noise_nmse = 0.0;  ///< what that alone makes of the reconstruction
  double left_out_nmse = 0.0;  ///< sum over what is left out, at most share_left_out times noise_nmse
  double left_out_lsb = 0.0;   ///< rms of the sum of all left out, at most: sum of the bounds
  Sensitivity sensitivity;

  /// Of an effect of the list.
  [[nodiscard]] const PlannedEffect& of(std::string_view effect) const;
  [[nodiscard]] bool leaves_nothing_out() const noexcept;
  /// Whether another sensitivity could decide otherwise: something is called for that is neither noise nor plainly too
  /// large to be left out.
  [[nodiscard]] bool depends_on_sensitivity() const noexcept;
};

/// Lines "effect NAME = DECISION; WHY; at most BOUND LSB": what has to be known of samples to trace a result.
[[nodiscard]] std::string provenance_of(const Plan& plan);

/// What is left out may add this share of what the noise itself makes of a reconstruction.
inline constexpr double share_left_out = 0.1;

enum class PlanMode {
  automatic,
  called,  ///< all that is called for, however small
  everything,
  nothing
};

/// What a plan may leave out. Only noise that is simulated hides anything: what a scene forces off does not.
struct Budget {
  PlanMode mode = PlanMode::automatic;
  bool rounded = true;  ///< false: samples are taken as exact levels, and rounding hides nothing either
};

/// How a simulation comes to its plan.
struct Planning {
  Budget budget = {};
  /// Measures how much a reconstruction of this scene bears, which may take seconds: asked only where an automatic plan
  /// depends on it. Empty: the figures of the paper's small eye serve.
  std::function<hal::Result<Sensitivity>(const Scene&)> measure = {};
  /// Of the looks at the scene and of its first frame; as long as a simulation is created.
  RenderWatch watch = {};
};

/// Leaves out the effects that save most time for their error, while what they add up to stays within the share; what
/// the scene forces is as it says. `everything`: all there are, called for or not; `nothing`: none.
[[nodiscard]] Plan plan_effects(const Circumstances& circumstances, const Sensitivity& sensitivity,
                                const Budget& budget = {}, std::span<const Effect* const> list = effects());

}  // namespace compueye::sim
