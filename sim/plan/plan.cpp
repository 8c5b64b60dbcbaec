#include "sim/plan/plan.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "sim/effects/effect_list.hpp"

namespace compueye::sim {
namespace {

bool simulated(const Effect& effect, const Scene& scene) {
  const auto forced = scene.effects.find(std::string(effect.name));
  return forced == scene.effects.end() || forced->second != Forced::off;
}

/// Rounding, and what photons and the converter add in every channel and frame, as far as it is simulated: where there
/// is no noise nothing hides behind it.
double noise_of(const Circumstances& c, bool rounded) {
  const double rounding_variance = rounded ? 1.0 / 12.0 : 0.0, electrons = c.board.detector.electrons_per_lsb;
  const double read = simulated(effect::read_noise, c.scene) ? c.board.sensor.read_noise_lsb : 0.0;
  const bool photons = electrons > 0.0 && simulated(effect::shot_noise, c.scene);
  const double shot_variance = photons ? std::max(c.preview.mean, 0.0) / electrons : 0.0;
  return std::sqrt(rounding_variance + read * read + shot_variance);
}

/// Two renderings of the same light differ by so many LSB rms at most: each keeps to .05 (simulation.cpp) for every
/// surface, with its cones and instants, and is as white as noise.
double rendered_anew(const Effect& effect, const Scene& scene) noexcept {
  const double lsb = 0.1 * static_cast<double>(scene.surfaces.size());
  const bool renders =
      effect.group == EffectGroup::scene || effect.group == EffectGroup::optics || effect.group == EffectGroup::timing;
  return renders ? lsb : 0.0;
}

Decision forced_to(Forced forced) noexcept {
  return forced == Forced::on ? Decision::forced_on : Decision::forced_off;
}

PlannedEffect look_at(const Effect& effect, const Circumstances& c) {
  PlannedEffect planned;
  planned.effect = &effect;
  planned.called_for_by = effect.calls_for(c);
  planned.cost = effect.cost(c);
  if (!planned.called_for_by.empty()) planned.bound_lsb = effect.bound(c);
  const auto forced = c.scene.effects.find(std::string(effect.name));
  if (forced != c.scene.effects.end()) {
    planned.decision = forced_to(forced->second);
  } else {
    planned.decision = planned.called_for_by.empty() ? Decision::not_called : Decision::on;
  }
  return planned;
}

/// Those that are the planner's to leave out: first what costs least accuracy for the time it saves.
std::vector<PlannedEffect*> candidates(Plan& plan) {
  std::vector<PlannedEffect*> all;
  for (PlannedEffect& each : plan.effects) {
    if (each.decision == Decision::on) all.push_back(&each);
  }
  constexpr double seconds = 100.0;  // of frames that set-up is paid for
  const auto price = [&](const PlannedEffect& e) {
    return e.nmse / std::max(e.cost.set_up_s + seconds * e.cost.frame_s, 1e-12);
  };
  std::stable_sort(all.begin(), all.end(), [&](const auto* a, const auto* b) { return price(*a) < price(*b); });
  return all;
}

void leave_out(Plan& plan) {
  for (PlannedEffect* each : candidates(plan)) {
    if (!(plan.left_out_nmse + each->nmse <= share_left_out * plan.noise_nmse)) continue;
    plan.left_out_nmse += each->nmse;
    plan.left_out_lsb += each->bound_lsb;
    each->decision = Decision::left_out;
  }
}

}  // namespace

std::string_view name(Decision decision) noexcept {
  switch (decision) {
    case Decision::on:
      return "on";
    case Decision::left_out:
      return "left out";
    case Decision::not_called:
      return "not called for";
    case Decision::forced_on:
      return "on, as asked";
    case Decision::forced_off:
      return "off, as asked";
  }
  return "";
}

Sensitivity Sensitivity::of_small_eye() noexcept {
  return {{330.0, 330.0, 1.0, 13.0, 950.0}, false};
}

const PlannedEffect& Plan::of(std::string_view effect) const {
  return *std::find_if(effects.begin(), effects.end(), [&](const auto& each) { return each.effect->name == effect; });
}

bool Plan::depends_on_sensitivity() const noexcept {
  constexpr double plainly = 10.0;  // of the noise: no kind of error is borne so much better than noise
  return std::any_of(effects.begin(), effects.end(), [&](const PlannedEffect& e) {
    const bool open = e.decision == Decision::on || e.decision == Decision::left_out;
    return open && e.effect->error != ErrorKind::white && e.bound_lsb <= plainly * noise_lsb;
  });
}

bool Plan::leaves_nothing_out() const noexcept {
  return std::all_of(effects.begin(), effects.end(),
                     [](const PlannedEffect& each) { return each.on() || each.decision == Decision::not_called; });
}

std::string provenance_of(const Plan& plan) {
  std::string text;
  for (const PlannedEffect& each : plan.effects) {
    if (each.decision == Decision::not_called) continue;
    char bound[32];
    std::snprintf(bound, sizeof bound, "%.3g", each.bound_lsb);
    text += "effect " + std::string(each.effect->name) + " = " + std::string(name(each.decision));
    if (!each.called_for_by.empty()) text += "; " + each.called_for_by + "; at most " + bound + " LSB";
    text += "\n";
  }
  return text;
}

Plan plan_effects(const Circumstances& circumstances, const Sensitivity& sensitivity, const Budget& budget,
                  std::span<const Effect* const> list) {
  const PlanMode mode = budget.mode;
  Plan plan;
  plan.sensitivity = sensitivity;
  plan.signal_rms_lsb = circumstances.preview.rms;
  plan.noise_lsb = noise_of(circumstances, budget.rounded);
  const auto nmse_of = [&](double error_lsb, ErrorKind kind) {
    if (error_lsb == 0.0) return 0.0;
    // Without light there is no picture to spoil: errors are weighed as beside one LSB of signal.
    const double share = error_lsb / std::max(plan.signal_rms_lsb, 1.0);
    return sensitivity.of(kind) * share * share;
  };
  plan.noise_nmse = nmse_of(plan.noise_lsb, ErrorKind::white);
  for (const Effect* effect : list) {
    PlannedEffect& planned = plan.effects.emplace_back(look_at(*effect, circumstances));
    planned.nmse = nmse_of(planned.bound_lsb, effect->error);
    if (!planned.called_for_by.empty()) {
      const double anew = rendered_anew(*effect, circumstances.scene);
      planned.bound_lsb += anew;
      planned.nmse += nmse_of(anew, ErrorKind::white);
    }
    if (planned.decision == Decision::forced_on || planned.decision == Decision::forced_off) continue;
    if (mode == PlanMode::everything) planned.decision = Decision::on;
    if (mode == PlanMode::nothing && planned.decision == Decision::on) planned.decision = Decision::left_out;
  }
  if (mode == PlanMode::automatic) leave_out(plan);
  return plan;
}

}  // namespace compueye::sim
