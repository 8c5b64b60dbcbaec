// The planner keeps its promise before every scene that is shipped, on four eyes: what it leaves out changes samples by
// no more than it says, and a reconstruction by no more than a tenth of what the noise does.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "firmware/eye/board.hpp"
#include "firmware/eye/planned_eye.hpp"
#include "firmware/eye/ready_eye.hpp"
#include "firmware/eye/scene_choice.hpp"
#include "firmware/eye/simulated_board.hpp"
#include "hal/clock.hpp"
#include "recon/aligned_workspace.hpp"
#include "sim/simulated_eye.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/sanitized.hpp"
#include "tests/source_folder.hpp"

using namespace compueye;
using namespace compueye::firmware;

namespace {

/// With COMPUEYE_WHOLE_GRID every effect is looked at before every scene and board, which takes ten minutes; else each
/// effect once before each board, and a board before every third scene but the relief.
const bool whole_grid = std::getenv("COMPUEYE_WHOLE_GRID") != nullptr;

/// Between two renderings of the same light, at most.
constexpr double rendered_to_lsb = 0.3;

constexpr std::uint64_t frames = test::sanitized ? 2 : 4;

Board board_8x8() {
  return load_board(test::source_path("boards/sim-8x8")).value();
}

Board as_built() {
  Board board = board_8x8();
  board.name = "as-built";
  board.build.pose_rms_deg = 0.1;
  board.build.acceptance_spread = 0.01;
  board.build.dust_share = 0.15;
  board.build.coma = 0.05;
  board.build.crosstalk = 0.02;
  board.build.gain_spread = 0.01;
  board.build.offset_spread_lsb = 2.0;
  return board;
}

/// Few electrons, one converter for eight photodiodes, a bow.
Board dim() {
  Board board = board_8x8();
  board.name = "dim";
  board.sensor.bits = 12;
  board.sensor.read_noise_lsb = 0.8;
  board.detector.electrons_per_lsb = 4.0;
  board.detector.dark_current_e_per_s = 50.0;
  board.detector.inl_lsb = 0.5;
  board.detector.mux_channels = 8;
  board.detector.mux_slot_us = 100.0;
  board.detector.mux_time_constant_us = 15.0;
  board.detector.flicker_noise_lsb = 0.05;
  return board;
}

Board wide() {
  Board board = board_8x8();
  board.name = "wide";
  board.eye.rows = board.eye.columns = 12;
  board.eye.interommatidial_rad = 0.07;
  board.eye.acceptance_rad = 0.7;
  board.object = {18, 18, 20.0, 20.0, 12.0};
  board.sensor.full_scale = 512.0;
  board.build.lens_diameter_mm = 0.05;
  board.build.refractive_index = 1.4;
  board.build.vignetting = 0.02;
  return board;
}

std::vector<std::string> scene_files() {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(test::source_path("scenes"))) {
    const bool dear = entry.path().stem() == "relief";  // takes half a minute each time
    if (entry.path().extension() == ".toml" && (whole_grid || !dear)) files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// Those that board number `board` is looked at before.
std::vector<std::string> scene_files_for(std::size_t board) {
  const auto all = scene_files();
  if (whole_grid) return all;
  std::vector<std::string> some;
  for (std::size_t k = board % 3; k < all.size(); k += 3) some.push_back(all[k]);
  return some;
}

using Eye = std::unique_ptr<sim::SimulatedEye>;

std::vector<double> levels_of(sim::SimulatedEye& eye, std::uint64_t frame) {
  const auto levels = eye.levels_lsb(frame);
  return {levels.begin(), levels.end()};
}

struct Difference {
  double rms_lsb = 0.0;  ///< over channels and frames
  double nmse = 0.0;     ///< of reconstructions, largest frame
};

class Grid {
 public:
  explicit Grid(Board board) : board_(std::move(board)) {
    const auto go_on = [](std::string_view, double, double) { return true; };
    living_ = living_response(board_, go_on).value();
    ready_.emplace(ReadyEye::make(board_, *living_, "", go_on).value());
  }

  [[nodiscard]] Eye eye(const sim::Scene& scene, sim::PlanMode mode) {
    auto settings = simulated_eye_settings(board_, scene, 3);
    settings.plan = mode;
    if (mode != sim::PlanMode::automatic) return sim::SimulatedEye::create(std::move(settings), clock_).value();
    return planned_eye(board_, std::move(settings), clock_, {}).value();
  }

  /// Over frames spread over the scene's duration, or over the hour that bounds look at.
  [[nodiscard]] Difference between(sim::SimulatedEye& a, sim::SimulatedEye& b) {
    const double duration_s = a.settings().scenes[0].duration_s;
    const double looked_at = (duration_s > 0.0 ? duration_s : 3600.0) * board_.source.frame_rate_hz;
    Difference found;
    double squares = 0.0;
    for (std::uint64_t k = 0; k < frames; ++k) {
      const auto f = static_cast<std::uint64_t>((static_cast<double>(k) + 0.37) / frames * looked_at);
      const auto of_a = levels_of(a, f), of_b = levels_of(b, f);
      for (std::size_t m = 0; m < of_a.size(); ++m) squares += std::pow(of_a[m] - of_b[m], 2);
      found.nmse = std::max(found.nmse, change(of_a, of_b));
    }
    found.rms_lsb = std::sqrt(squares / static_cast<double>(frames) / static_cast<double>(board_.eye.ommatidia()));
    return found;
  }

 private:
  [[nodiscard]] std::vector<float> picture_of(const std::vector<double>& levels) const {
    std::vector<float> y(levels.size()), x(static_cast<std::size_t>(board_.object.pixels()));
    for (std::size_t m = 0; m < y.size(); ++m) {
      y[m] = static_cast<float>((levels[m] - board_.sensor.dark_level_lsb) * board_.sensor.lsb());
    }
    const recon::Reconstructor& solver = ready_->reconstructor();
    const recon::AlignedWorkspace workspace(solver.required_bytes());
    REQUIRE(solver.solve(y, {}, workspace.span(), x).health != recon::Health::invalid);
    return x;
  }
  [[nodiscard]] double change(const std::vector<double>& a, const std::vector<double>& b) const {
    const auto of_a = picture_of(a), of_b = picture_of(b);
    double changed = 0.0, whole = 0.0;
    for (std::size_t n = 0; n < of_a.size(); ++n) {
      changed += std::pow(static_cast<double>(of_a[n]) - static_cast<double>(of_b[n]), 2);
      whole += std::pow(static_cast<double>(of_a[n]), 2);
    }
    return whole > 0.0 ? changed / whole : 0.0;
  }

  Board board_;
  hal::VirtualClock clock_;
  std::optional<LivingResponse> living_;
  std::optional<ReadyEye> ready_;
};

/// What so many draws of noise, of the converter or of photons, may be above its rms: four standard errors.
double drawn_share(const sim::Effect& effect, const Board& board) {
  if (effect.error != sim::ErrorKind::white && board.detector.electrons_per_lsb == 0.0) return 1.0;
  return 1.0 + 4.0 / std::sqrt(2.0 * static_cast<double>(frames) * board.eye.ommatidia());
}

}  // namespace

TEST_CASE("what is planned differs from everything by no more than the plan says, in LSB and in the picture") {
  CHECK(scene_files().size() >= 12);
  std::size_t number = 0;
  int left_out = 0;
  for (const Board& board : {board_8x8(), as_built(), dim(), wide()}) {
    Grid grid(board);
    for (const std::string& file : scene_files_for(number++)) {
      const std::string name = std::filesystem::path(file).stem();
      CAPTURE(board.name);
      CAPTURE(name);
      const auto scene = choose_scene(board, {file, 0, std::nullopt});
      REQUIRE_MESSAGE(scene.has_value(), (scene ? std::string() : scene.error().text()));
      const Eye planned = grid.eye(*scene, sim::PlanMode::automatic);
      const sim::Plan& plan = planned->plan(0);
      if (plan.leaves_nothing_out()) continue;
      ++left_out;
      const Eye everything = grid.eye(*scene, sim::PlanMode::everything);
      const Difference found = grid.between(*everything, *planned);
      CHECK(found.rms_lsb <= 1.2 * plan.left_out_lsb);  // draws of noise may be above its rms
      CHECK(found.nmse <= sim::share_left_out * std::max(plan.noise_nmse, 1e-4));
    }
  }
  CHECK(left_out > 0);
}

TEST_CASE("no bound is less than the truth, nor more than ten times where an effect dominates") {
  std::map<std::string, int> looked;
  for (const Board& board : {board_8x8(), as_built(), dim(), wide()}) {
    Grid grid(board);
    for (const std::string& file : scene_files()) {
      const std::string name = std::filesystem::path(file).stem();
      CAPTURE(board.name);
      CAPTURE(name);
      const sim::Scene scene = choose_scene(board, {file, 0, std::nullopt}).value();
      Eye everything;
      const sim::Plan plan = grid.eye(scene, sim::PlanMode::automatic)->plan(0);
      double largest = 0.0;
      for (const auto& each : plan.effects) largest = std::max(largest, each.bound_lsb);
      for (const auto& each : plan.effects) {
        const std::string effect(each.effect->name);
        if (each.called_for_by.empty() || (looked[board.name + effect]++ > 0 && !whole_grid)) continue;
        CAPTURE(effect);
        CAPTURE(each.called_for_by);
        if (!everything) everything = grid.eye(scene, sim::PlanMode::everything);
        sim::Scene without = scene;
        without.effects[effect] = sim::Forced::off;
        const double truth = grid.between(*everything, *grid.eye(without, sim::PlanMode::everything)).rms_lsb;
        CHECK(each.bound_lsb * drawn_share(*each.effect, board) >= truth);
        if (each.bound_lsb >= 0.5 * largest) CHECK(each.bound_lsb <= 10.0 * truth);
      }
    }
  }
}

TEST_CASE("what nothing calls for changes nothing but how light is rendered to its tolerance") {
  std::size_t number = 1;
  for (const Board& board : {board_8x8(), as_built(), dim()}) {
    Grid grid(board);
    for (const std::string& file : scene_files_for(number++)) {
      const std::string name = std::filesystem::path(file).stem();
      CAPTURE(board.name);
      CAPTURE(name);
      sim::Scene scene = choose_scene(board, {file, 0, std::nullopt}).value();
      const Eye everything = grid.eye(scene, sim::PlanMode::everything);
      for (const auto& each : everything->plan(0).effects) {
        if (each.called_for_by.empty()) scene.effects[std::string(each.effect->name)] = sim::Forced::off;
      }
      const Eye called = grid.eye(scene, sim::PlanMode::everything);
      for (std::uint64_t f = 0; f < 2; ++f) {
        const auto all = levels_of(*everything, f), some = levels_of(*called, f);
        for (std::size_t m = 0; m < all.size(); ++m) CHECK(std::fabs(all[m] - some[m]) <= rendered_to_lsb);
      }
    }
  }
}
