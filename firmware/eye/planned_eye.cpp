#include "firmware/eye/planned_eye.hpp"

#include <algorithm>
#include <utility>

#include "firmware/eye/ready_eye.hpp"
#include "hal/try.hpp"
#include "recon/sensitivity.hpp"
#include "sim/scene/scene_truth.hpp"

namespace compueye::firmware {
namespace {

using hal::Result;

/// In the order of sim::ErrorKind.
sim::Sensitivity handed_over(const recon::Sensitivity& s) {
  // What does not change a picture at all would let anything pass; a digit of float32 is the least that can be said.
  constexpr double least = 1e-6;
  sim::Sensitivity figures{{s.white, s.per_channel, s.common_gain, s.offset, s.row_shape}, true};
  for (double& kappa : figures.kappa) kappa = std::max(kappa, least);
  return figures;
}

/// Of a scene that the object plane's pixels show nothing of, nothing can be measured.
bool is_black(const hal::Image& truth) {
  return std::all_of(truth.pixels.begin(), truth.pixels.end(), [](float v) { return v == 0.0F; });
}

Result<sim::Sensitivity> sensitivity_to(const Board& board, const sim::Scene& scene, const recon::Progress& progress) {
  const hal::Image truth = TRY(sim::scene_truth(scene, board.object));
  if (is_black(truth)) return sim::Sensitivity::of_small_eye();
  // What is planned is the eye as drawn, whatever was measured of one.
  Board drawn = board;
  drawn.eye_file.clear();
  const LivingResponse living = TRY(living_response(drawn, progress));
  const ReadyEye ready = TRY(ReadyEye::make(drawn, living, drawn.cache(), progress));
  return handed_over(
      TRY(recon::measure_sensitivity(living.response, ready.reconstructor(), truth, board.noise_sigma(), progress)));
}

}  // namespace

Result<std::unique_ptr<sim::SimulatedEye>> planned_eye(const Board& board, sim::SimulatedEyeSettings settings,
                                                       hal::Clock& clock, const recon::Progress& progress) {
  const recon::Progress told =
      progress ? progress : recon::Progress([](std::string_view, double, double) { return true; });
  settings.planning.measure = [&](const sim::Scene& scene) { return sensitivity_to(board, scene, told); };
  return sim::SimulatedEye::create(std::move(settings), clock);
}

}  // namespace compueye::firmware
