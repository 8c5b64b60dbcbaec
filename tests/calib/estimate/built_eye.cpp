#include "tests/calib/estimate/built_eye.hpp"
#include "tests/hal/units.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "hal/try.hpp"
#include "sim/effects/effect_list.hpp"
#include "sim/render/renderer.hpp"
#include "sim/simulation.hpp"

namespace compueye::test {
namespace {

/// The board with a converter so fine that renders are exact and steps do not show, and nothing drawn anew each frame.
sim::EyeToSimulate without_noise(sim::EyeToSimulate board) {
  board.sensor.bits = 20;
  board.sensor.read_noise_lsb = 0.0;
  board.sensor.dark_level_lsb = 0.0;
  board.sensor.dead.clear();
  board.build.offset_spread_lsb = 0.0;
  board.detector = {};
  return board;
}

/// The faults of boards/sim-8x8-built.
sim::EyeToSimulate with_faults(sim::EyeToSimulate board) {
  board.build.pose_rms_deg = 0.2;
  board.build.apex_rms_mm = 0.01;
  board.build.acceptance_spread = 0.03;
  board.build.profile = hal::ProfileKind::soft;
  board.build.edge_order = 8.0;
  board.build.coma = 0.1;
  board.build.dust_share = 0.15;
  board.build.crosstalk = 0.02;
  board.build.gain_spread = 0.02;
  board.build.offset_spread_lsb = 3.0;
  return board;
}

/// The simulator's soft profile is a stack of twelve cones, whose stairs are ten pixels wide on the far side of a cone
/// of 60 degrees that looks aside: no lens has those. This is the same profile of ten times as many.
void soften(double order, sim::OpticsAsBuilt& optics) {
  constexpr int shells = 120;
  for (sim::OmmatidiumOptics& each : optics.ommatidia) {
    std::vector<sim::ConeOfLight> cones;
    for (const sim::ConeOfLight& cone : each.cones) {
      for (int s = 0; s < shells; ++s) {
        const double t = (s + 0.5) / shells, height = t * t * (3.0 - 2.0 * t);
        const double half = cone.half_angle_rad * std::pow(-std::log2(height), 1.0 / order);
        cones.push_back({cone.axis, std::min(half, 60.0 * deg), cone.weight * 6.0 * t * (1.0 - t) / shells});
      }
    }
    each.cones = std::move(cones);
  }
}

/// The optics of every ommatidium, and what happens to signals behind them.
sim::Workings workings_of(const sim::EyeToSimulate& board, const sim::Scene& scene) {
  sim::Workings workings;
  workings.scene = scene;
  workings.optics = sim::OpticsAsBuilt::drawn(board.eye);
  const sim::Preview nobody_looked;
  const sim::Circumstances circumstances{board, scene, nobody_looked};
  for (const char* name : {"misalignment", "acceptance_spread", "", "coma", "dust", "crosstalk", "gain_spread"}) {
    if (*name == 0) {
      soften(board.build.edge_order, workings.optics);
    } else {
      sim::effect_named(name).value()->apply(circumstances, workings);
    }
  }
  return workings;
}

/// A white sheet of one pixel's size.
sim::Scene lit_pixel(const hal::ObjectPlane& object, int row, int col) {
  hal::ObjectPlane one = object;
  one.rows = one.cols = 1;
  one.width_mm = object.pixel_width_mm();
  one.height_mm = object.pixel_height_mm();
  sim::Scene scene = sim::scene_on(one, "pixel", hal::Image(1, 1, 1.0F));
  scene.surfaces.front().pose.centre_mm.x = (col + 0.5 - object.cols / 2.0) * one.width_mm;
  scene.surfaces.front().pose.centre_mm.y = (object.rows / 2.0 - row - 0.5) * one.height_mm;
  return scene;
}

PixelResponses empty_responses(int pixels) {
  PixelResponses responses;
  responses.pixels = pixels;
  return responses;
}

hal::Result<void> render_row(const sim::EyeToSimulate& board, const sim::OmmatidiumOptics& optics,
                             std::span<double> row) {
  hal::EyeGeometry alone = board.eye;
  alone.rows = alone.columns = 1;
  sim::RenderSettings settings;
  settings.true_depth = true;
  settings.tolerance = 1e-5;
  for (int r = 0; r < board.object.rows; ++r) {
    for (int c = 0; c < board.object.cols; ++c) {
      const sim::Scene scene = lit_pixel(board.object, r, c);
      sim::OpticsAsBuilt one;
      one.ommatidia = {optics};
      auto renderer = TRY(sim::Renderer::create(alone, board.object, std::move(one), settings, scene));
      double signal = 0.0;
      renderer.render(0.0, {&signal, 1});
      row[static_cast<std::size_t>(r * board.object.cols + c)] = signal;
    }
  }
  return {};
}

}  // namespace

sim::EyeToSimulate small_built_eye() {
  sim::EyeToSimulate board;
  board.eye.interommatidial_rad = 1.5 * deg;
  board.eye.acceptance_rad = 8.0 * deg;
  board.sensor.bits = 12;
  board.sensor.full_scale = 128.0;
  board.sensor.read_noise_lsb = 1.0;
  board.sensor.dark_level_lsb = 64.0;
  return with_faults(board);
}

sim::EyeToSimulate large_built_eye() {
  sim::EyeToSimulate board;
  board.eye.rows = board.eye.columns = 80;
  board.eye.interommatidial_rad = 2.25 * deg;
  board.eye.acceptance_rad = 60.0 * deg;
  board.object = {160, 160, 60.0, 60.0, 10.0};
  board.sensor.bits = 16;
  board.sensor.full_scale = 4096.0;
  board.sensor.read_noise_lsb = 5.06;
  board.sensor.dark_level_lsb = 64.0;
  return with_faults(board);
}

hal::Result<PixelResponses> pixel_responses(const sim::EyeToSimulate& board) {
  const sim::EyeToSimulate exact = without_noise(board);
  PixelResponses all = empty_responses(board.object.pixels());
  const auto pixels = static_cast<std::size_t>(all.pixels);
  for (int m = 0; m < board.eye.ommatidia(); ++m) all.ommatidia.push_back(m);
  all.light.resize(all.ommatidia.size() * pixels);
  all.signals.resize(all.light.size());
  for (std::size_t n = 0; n < pixels; ++n) {
    hal::Image picture(board.object.rows, board.object.cols);
    picture.pixels[n] = 1.0F;
    sim::Scene scene = sim::scene_on(board.object, "pixel", std::move(picture));
    auto eye = TRY(sim::Simulation::create(exact, std::move(scene), 1, {.budget = {sim::PlanMode::everything}}));
    const auto light = eye.noise_free(0);
    for (std::size_t m = 0; m < light.size(); ++m) all.light[m * pixels + n] = light[m];
    const auto levels = eye.levels_lsb(0);
    for (std::size_t m = 0; m < levels.size(); ++m) all.signals[m * pixels + n] = levels[m] * exact.sensor.lsb();
  }
  return all;
}

hal::Result<PixelResponses> pixel_responses_of(const sim::EyeToSimulate& board, std::span<const int> ommatidia) {
  PixelResponses all = empty_responses(board.object.pixels());
  const auto pixels = static_cast<std::size_t>(all.pixels);
  all.ommatidia.assign(ommatidia.begin(), ommatidia.end());
  all.light.resize(ommatidia.size() * pixels);
  all.signals.resize(all.light.size());
  const sim::Scene scene = lit_pixel(board.object, 0, 0);
  const sim::Workings workings = workings_of(board, scene);
  for (std::size_t i = 0; i < ommatidia.size(); ++i) {
    const sim::OmmatidiumOptics& optics = workings.optics.ommatidia[static_cast<std::size_t>(ommatidia[i])];
    TRY(render_row(board, optics, std::span(all.light).subspan(i * pixels, pixels)));
  }
  std::vector<double> levels(static_cast<std::size_t>(board.eye.ommatidia()));
  std::vector<std::int32_t> stuck(levels.size(), -1);
  for (std::size_t n = 0; n < pixels; ++n) {
    std::fill(levels.begin(), levels.end(), 0.0);
    for (std::size_t i = 0; i < ommatidia.size(); ++i) {
      levels[static_cast<std::size_t>(ommatidia[i])] = all.light[i * pixels + n];
    }
    sim::FrameInWork frame{0, 0.0, levels, stuck};
    for (const auto& step : workings.steps) step->apply(frame);
    for (std::size_t i = 0; i < ommatidia.size(); ++i) {
      all.signals[i * pixels + n] = levels[static_cast<std::size_t>(ommatidia[i])];
    }
  }
  return all;
}

}  // namespace compueye::test
