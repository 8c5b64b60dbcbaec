#include "studies/effects/effect_gallery.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "firmware/eye/simulated_board.hpp"
#include "firmware/sinks/contact_sheet.hpp"
#include "firmware/text/number_text.hpp"
#include "hal/try.hpp"
#include "sim/simulation.hpp"

namespace compueye::firmware {
namespace {

using hal::Result;

constexpr int scene_pixels = 200;

/// The frame's levels where their ommatidia are, LSB.
Result<hal::Image> levels_of(sim::Simulation& simulation, std::uint64_t frame) {
  const hal::EyeGeometry& eye = simulation.board().eye;
  hal::Image image(eye.rows, eye.columns);
  const auto levels = simulation.levels_lsb(frame);
  std::transform(levels.begin(), levels.end(), image.pixels.begin(), [](double v) { return static_cast<float>(v); });
  return image;
}

Result<sim::Simulation> simulated(const Board& board, sim::Scene scene, std::uint64_t seed,
                                  const sim::RenderWatch& watch) {
  auto settings = simulated_eye_settings(board, std::move(scene), seed);
  auto simulation = TRY(sim::Simulation::create(settings.board, std::move(settings.scenes.front()), seed,
                                                {.budget = {sim::PlanMode::everything}, .watch = watch}));
  simulation.watch(watch);
  return simulation;
}

/// Both panels of an effect: the samples without it, brightest white, and what it adds to them.
Result<std::vector<Panel>> row_of(const sim::PlannedEffect& effect, const hal::Image& with, const hal::Image& without) {
  float most = 1e-6F;
  double squares = 0.0;
  for (const float v : without.pixels) most = std::max(most, v);
  hal::Image shown = without;
  for (float& v : shown.pixels) v /= most;
  for (std::size_t m = 0; m < with.pixels.size(); ++m) {
    squares += std::pow(static_cast<double>(with.pixels[m]) - static_cast<double>(without.pixels[m]), 2);
  }
  const double rms = std::sqrt(squares / static_cast<double>(with.pixels.size()));
  Panel before{std::string(effect.effect->name), {effect.called_for_by, "the frame without it"}, std::move(shown)};
  before.begins_row = true;
  Panel change = TRY(error_panel(with, without));
  change.name = "what it changes";
  change.figures = {fmt::format("{} LSB rms", significant(rms, 2)),
                    fmt::format("bound {}", significant(effect.bound_lsb, 2))};
  return std::vector<Panel>{std::move(before), std::move(change)};
}

}  // namespace

Result<void> write_effect_gallery(const Board& board, const sim::Scene& scene, const GalleryRequest& request,
                                  const recon::Progress& progress) {
  double done = 0.0;
  const auto told = [&](std::string_view, double share) {
    return !progress || progress("effects", done + share, static_cast<double>(sim::effects().size()));
  };
  sim::Simulation whole = TRY(simulated(board, scene, request.seed, told));
  const hal::Image with = TRY(levels_of(whole, request.frame));
  std::vector<Panel> panels;
  const auto& effects = whole.plan().effects;
  for (std::size_t k = 0; k < effects.size(); ++k) {
    if (effects[k].called_for_by.empty() || !effects[k].on()) continue;
    done = static_cast<double>(k);
    if (!told("", 0.0)) {
      return hal::fail(hal::ErrorCode::interrupted, request.png, "was stopped before it was written");
    }
    sim::Scene left_out = scene;
    left_out.effects[std::string(effects[k].effect->name)] = sim::Forced::off;
    sim::Simulation rest = TRY(simulated(board, std::move(left_out), request.seed, told));
    for (Panel& panel : TRY(row_of(effects[k], with, TRY(levels_of(rest, request.frame))))) {
      panels.push_back(std::move(panel));
    }
  }
  if (panels.empty()) {
    return hal::fail(hal::ErrorCode::not_found, request.png,
                     "nothing calls for any effect, so there is none to show; see simulate --explain");
  }
  return write_contact_sheet(request.png, fmt::format("{} before {}, frame {}", scene.name, board.name, request.frame),
                             panels, scene_pixels);
}

}  // namespace compueye::firmware
