#include "firmware/calibration/simulated_bench.hpp"

#include <cmath>
#include <string>
#include <utility>

#include "calib/patterns/pattern_family.hpp"
#include "firmware/eye/simulated_board.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

hal::Result<void> check_display(const sim::Scene& scene, const hal::ObjectPlane& plane) {
  const auto refuse = [&](const char* what) {
    return hal::fail(hal::ErrorCode::mismatch, scene.name,
                     std::string(what) +
                         "; a calibration's display is one grey [[surface]] of shape \"plane\" with "
                         "shines = true, still and as large as the object plane");
  };
  if (scene.surfaces.size() != 1) return refuse("shows more than one surface");
  const sim::Surface& display = scene.surfaces.front();
  const auto off = [](double a, double b) { return std::fabs(a - b) > 1e-9 * b; };
  if (display.shape != sim::Shape::plane || !scene.still()) return refuse("is curved or moves");
  if (!display.shines) return refuse("is lit and does not shine");
  if (display.bands.size() != 1) return refuse("is coloured");
  if (off(display.width_mm, plane.width_mm) || off(display.height_mm, plane.height_mm)) {
    return refuse("has another size than the object plane");
  }
  return {};
}

}  // namespace

sim::Scene plain_display(const Board& board) {
  sim::Scene scene =
      sim::scene_on(board.object, "plain display", hal::Image(board.object.rows, board.object.cols, 1.0F));
  scene.surfaces.front().shines = true;
  return scene;
}

hal::Result<sim::Scene> display_of_patterns(const Board& board, const sim::Scene& scene, std::uint64_t seed) {
  TRY(check_display(scene, board.object));
  sim::Scene display = scene;
  // Effects are planned by what is going to be shown; before white all over half of them would have no reason.
  display.surfaces.front().bands = {
      TRY(TRY(calib::pattern_family("blobs"))->draw(board.object.rows, board.object.cols, seed, 0))};
  return display;
}

hal::Result<SimulatedBench> SimulatedBench::create(const Board& board, const sim::Scene& scene, std::uint64_t seed) {
  sim::Scene display = TRY(display_of_patterns(board, scene, seed));
  SimulatedBench bench;
  bench.clock = std::make_unique<hal::VirtualClock>();
  auto settings = simulated_eye_settings(board, std::move(display), seed);
  settings.frame_rate_hz = board.source.frame_rate_hz;
  settings.planning.budget.mode = sim::PlanMode::called;
  bench.eye = TRY(sim::SimulatedEye::create(std::move(settings), *bench.clock));
  bench.display = std::make_unique<sim::SimulatedDisplay>(*bench.eye, *bench.clock);
  return bench;
}

}  // namespace compueye::firmware
