#include "firmware/eye/planned_eye.hpp"

#include <algorithm>
#include <utility>

#include "firmware/eye/picture_quality.hpp"
#include "firmware/eye/ready_eye.hpp"
#include "firmware/files/sensitivity_cache.hpp"
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

/// What is planned is the eye as drawn, whatever was measured of one; and where a box holds back what errors make
/// brighter than white, a picture of white would bear any error.
Board judged(Board board) {
  board.eye_file.clear();
  if (board.objective.constraint == recon::ConstraintKind::box) board.objective.hi *= 2.0;
  return board;
}

Result<recon::Sensitivity> measured(const Board& board, const LivingResponse& living, const hal::Image& truth,
                                    const recon::Progress& progress) {
  const ReadyEye ready = TRY(ReadyEye::make(board, living, board.cache(), progress));
  return recon::measure_sensitivity(living.response, ready.reconstructor(), truth, board.noise_sigma(), progress);
}

/// That takes some thirty frames, and is kept in the board's cache for the next time.
Result<sim::Sensitivity> sensitivity_to(const Board& drawn, const sim::Scene& scene, const recon::Progress& progress) {
  const hal::Image truth = TRY(sim::scene_truth(scene, drawn.object));
  // Of a scene that the object plane's pixels show nothing of, nothing can be measured.
  if (is_black(truth)) return sim::Sensitivity::of_small_eye();
  const Board board = judged(drawn);
  const LivingResponse living = TRY(living_response(board, progress));
  recon::Objective objective = board.objective;
  constexpr double by_rule = -1.0;  // which follows from what is in the key; 0 may be somebody's choice
  objective.lambda = board.lambda.value_or(by_rule);
  const SensitivityKey key =
      sensitivity_key(living.response.content_hash(), truth, objective, board.plan, board.noise_sigma());
  if (const auto kept = load_sensitivity(board.cache(), key)) return handed_over(*kept);
  const recon::Sensitivity found = TRY(measured(board, living, truth, progress));
  // A board's folder may be read-only: then it is measured again.
  (void)store_sensitivity(board.cache(), key, found);
  return handed_over(found);
}

}  // namespace

Result<std::unique_ptr<sim::SimulatedEye>> planned_eye(const Board& board, sim::SimulatedEyeSettings settings,
                                                       hal::Clock& clock, const recon::Progress& progress) {
  const recon::Progress told =
      progress ? progress : recon::Progress([](std::string_view, double, double) { return true; });
  settings.planning.watch = [&](std::string_view what, double share) { return told(what, share, 1.0); };
  settings.planning.measure = [&](const sim::Scene& scene) { return sensitivity_to(board, scene, told); };
  return sim::SimulatedEye::create(std::move(settings), clock);
}

}  // namespace compueye::firmware
