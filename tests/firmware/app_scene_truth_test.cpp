#include <doctest/doctest.h>

#include <cstdint>

#include "firmware/eye/board.hpp"
#include "firmware/eye/scene/scene_choice.hpp"
#include "firmware/eye/simulated_board.hpp"
#include "hal/image.hpp"
#include "sim/scene/scene_truth.hpp"
#include "tests/source_folder.hpp"

using namespace compueye;
using namespace compueye::firmware;

namespace {

/// A white sheet of half the plane's width that moves right by one of its pixels every 10 ms, and begins anew.
sim::Scene moving_sheet(const hal::ObjectPlane& object) {
  sim::Scene scene = sim::scene_on(object, "sheet", hal::Image(1, 1, 1.0F));
  scene.surfaces[0].width_mm = object.width_mm / 2.0;
  scene.surfaces[0].motion.velocity_mm_per_s = {object.pixel_width_mm() / 10e-3, 0.0, 0.0};
  scene.duration_s = 45e-3;
  return scene;
}

/// Whole columns by which the sheet's left edge is right of where it was at first.
int columns_moved(const hal::Image& truth) {
  int dark = 0;
  while (dark < truth.cols && truth.at(truth.rows / 2, dark) < 0.5F) ++dark;
  return dark - truth.cols / 4;
}

}  // namespace

TEST_CASE("the truth of a frame is that of the middle of its exposure, in the scene's own time") {
  Board board = load_board(compueye::test::source_path("boards/sim-8x8")).value();
  board.source.frame_rate_hz = 50.0;
  const sim::Scene scene = moving_sheet(board.object);
  struct Case {
    double integration_ms;
    std::uint64_t frame;
    double own_ms;  ///< start of the exposure + half of it, by hand
  };
  for (const Case& c : {Case{0.0, 0, 10.0}, Case{0.0, 1, 30.0}, Case{10.0, 1, 25.0}, Case{10.0, 2, 45.0},
                        Case{0.0, 3, 25.0}, Case{10.0, 3, 20.0}}) {
    CAPTURE(c.integration_ms);
    CAPTURE(c.frame);
    board.detector.integration_ms = c.integration_ms;
    const hal::Image truth = truth_of_frame(board, scene, c.frame).value();
    const hal::Image expected = sim::scene_truth(scene, board.object, c.own_ms * 1e-3).value();
    CHECK(truth.pixels == expected.pixels);
    CHECK(columns_moved(truth) == static_cast<int>(c.own_ms / 10.0));
  }
}

TEST_CASE("a simulation is told all of the board that it asks for") {
  const Board board = load_board(compueye::test::source_path("boards/sim-8x8-detector")).value();
  const sim::EyeToSimulate eye = eye_to_simulate(board);
  CHECK(eye.eye.acceptance_rad == board.eye.acceptance_rad);
  CHECK(eye.object.pixels() == board.object.pixels());
  CHECK(eye.build.seed == board.build.seed);
  CHECK(eye.sensor.full_scale == board.sensor.full_scale);
  CHECK(eye.detector.mux_channels == board.detector.mux_channels);
  CHECK(eye.period_s() == 1.0 / board.source.frame_rate_hz);
}
