// The planner keeps its promise before every scene that is shipped, on four eyes: what it leaves out changes samples by
// no more than it says, and a reconstruction by no more than a tenth of what the noise does.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "firmware/eye/board.hpp"
#include "firmware/eye/planned_eye.hpp"
#include "firmware/eye/ready_eye.hpp"
#include "firmware/eye/scene/scene_choice.hpp"
#include "firmware/eye/simulated_board.hpp"
#include "hal/clock.hpp"
#include "recon/aligned_workspace.hpp"
#include "sim/plan/preview.hpp"
#include "sim/simulated_eye.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/sanitized.hpp"
#include "tests/source_folder.hpp"

using namespace compueye;
using namespace compueye::firmware;

namespace {

/// With COMPUEYE_WHOLE_GRID every effect is looked at before every scene and board, which takes ten minutes; else a
/// board before every third scene but the relief, and each effect before the first scene that calls for it, on the
/// board that is for its kind.
const bool whole_grid = std::getenv("COMPUEYE_WHOLE_GRID") != nullptr;

/// Between two renderings of the same light, at most.
constexpr double rendered_to_lsb = 0.3;

constexpr std::uint64_t frames = test::sanitized ? 2 : 4;

Board shipped(const std::string& name) {
  return load_board(test::source_path("boards/" + name)).value();
}

/// 40 degrees at the edge of what it sees: cones meet the plane in long ellipses.
Board wide() {
  Board board = shipped("sim-8x8");
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

/// Every third (or `step`-th) from number `first` on.
std::vector<std::string> scene_files_from(std::size_t first, std::size_t step = 3) {
  const auto all = scene_files();
  if (whole_grid) return all;
  std::vector<std::string> some;
  for (std::size_t k = first; k < all.size(); k += step) some.push_back(all[k]);
  return some;
}

using Eye = std::unique_ptr<sim::SimulatedEye>;

std::vector<double> levels_of(sim::SimulatedEye& eye, std::uint64_t frame) {
  const auto levels = eye.levels_lsb(frame);
  return {levels.begin(), levels.end()};
}

struct Difference {
  double rms_lsb = 0.0;  ///< over channels and frames
  double nmse = 0.0;     ///< of reconstructions, mean over frames, as bounds are rms over them
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
    settings.planning.budget.mode = mode;
    if (mode != sim::PlanMode::automatic) return sim::SimulatedEye::create(std::move(settings), clock_).value();
    return planned_eye(board_, std::move(settings), clock_, {}).value();
  }

  [[nodiscard]] sim::Plan plan(const sim::Scene& scene) const {
    const auto settings = simulated_eye_settings(board_, scene, 3);
    const sim::Preview preview = sim::preview_of(settings.board, scene).value();
    return sim::plan_effects({settings.board, scene, preview}, sim::Sensitivity::of_small_eye());
  }

  /// Over frames spread over the scene's duration and over the hour of drift that bounds look at.
  [[nodiscard]] Difference between(sim::SimulatedEye& a, sim::SimulatedEye& b) {
    const sim::Scene& scene = a.settings().scenes[0];
    const double judged_s = scene.seconds_to_judge();
    Difference found;
    double squares = 0.0;
    for (std::uint64_t k = 0; k < frames; ++k) {
      const double share = (static_cast<double>(k) + 0.37) / frames;
      const double rounds = std::floor(share * (scene.seconds_of_drift() / judged_s - 1.0));
      const auto f = static_cast<std::uint64_t>((rounds + share) * judged_s * board_.source.frame_rate_hz);
      const auto of_a = levels_of(a, f), of_b = levels_of(b, f);
      for (std::size_t m = 0; m < of_a.size(); ++m) squares += std::pow(of_a[m] - of_b[m], 2);
      found.nmse += change(of_a, of_b) / static_cast<double>(frames);
    }
    found.rms_lsb = std::sqrt(squares / static_cast<double>(frames) / static_cast<double>(board_.eye.ommatidia()));
    return found;
  }

 private:
  /// A run finds the channels that tell nothing and leaves them out.
  [[nodiscard]] std::vector<float> weights() const {
    std::vector<float> each(static_cast<std::size_t>(board_.eye.ommatidia()), 1.0F);
    const hal::DetectorSettings& detector = board_.detector;
    for (const auto* defects : {&detector.hot, &detector.stuck, &detector.blinking}) {
      for (const int channel : *defects) each[static_cast<std::size_t>(channel)] = 0.0F;
    }
    return each;
  }
  [[nodiscard]] std::vector<float> picture_of(const std::vector<double>& levels) const {
    std::vector<float> y(levels.size()), x(static_cast<std::size_t>(board_.object.pixels()));
    for (std::size_t m = 0; m < y.size(); ++m) {
      y[m] = static_cast<float>((levels[m] - board_.sensor.dark_level_lsb) * board_.sensor.lsb());
    }
    const recon::Reconstructor& solver = ready_->reconstructor();
    const recon::AlignedWorkspace workspace(solver.required_bytes());
    REQUIRE(solver.solve(y, weights(), workspace.span(), x).health != recon::Health::invalid);
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

/// Number of the scenes for which something is left out.
int check_plans(const Board& board, const std::vector<std::string>& files) {
  Grid grid(board);
  int left_out = 0;
  CAPTURE(board.name);
  for (const std::string& file : files) {
    CAPTURE(file);
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
  return left_out;
}

using Groups = std::set<sim::EffectGroup>;

/// The scenes, beginning with one of them.
std::vector<std::string> scene_files_after(const std::string& first) {
  std::vector<std::string> files = scene_files();
  std::rotate(files.begin(), std::find(files.begin(), files.end(), test::source_path("scenes/" + first + ".toml")),
              files.end());
  return files;
}

/// Number of the effects of these groups that any scene calls for.
std::size_t check_bounds(const Board& board, const Groups& groups, const std::vector<std::string>& files) {
  std::set<std::string> looked_at;
  Grid grid(board);
  CAPTURE(board.name);
  for (const std::string& file : files) {
    CAPTURE(file);
    const sim::Scene scene = choose_scene(board, {file, 0, std::nullopt}).value();
    const sim::Plan plan = grid.plan(scene);
    Eye everything;
    double largest = 0.0;
    for (const auto& each : plan.effects) largest = std::max(largest, each.bound_lsb);
    for (const auto& each : plan.effects) {
      const std::string effect(each.effect->name);
      if (each.called_for_by.empty()) continue;
      if (!whole_grid && (!groups.contains(each.effect->group) || looked_at.contains(effect))) continue;
      looked_at.insert(effect);
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
  return looked_at.size();
}

void check_uncalled(const Board& board, std::size_t first) {
  Grid grid(board);
  CAPTURE(board.name);
  for (const std::string& file : scene_files_from(first)) {
    CAPTURE(file);
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

}  // namespace

// What is planned differs from everything by no more than the plan says, in LSB and in the picture.

TEST_CASE("plans keep their promise before an eye as drawn") {
  CHECK(scene_files().size() >= 12);
  CHECK(check_plans(shipped("sim-8x8"), scene_files_from(0)) > 0);
}

TEST_CASE("plans keep their promise before an eye as built") {
  CHECK(check_plans(shipped("sim-8x8-built"), scene_files_from(4, 6)) > 0);
}

TEST_CASE("plans keep their promise before an honest detector") {
  CHECK(check_plans(shipped("sim-8x8-detector"), scene_files_from(2)) > 0);
}

TEST_CASE("plans keep their promise before wide cones") {
  CHECK(check_plans(wide(), scene_files_from(0)) > 0);
}

// No bound is less than the truth, nor more than ten times where an effect dominates.

TEST_CASE("bounds hold for what scenes do") {
  CHECK(check_bounds(shipped("sim-8x8"), {sim::EffectGroup::scene, sim::EffectGroup::timing},
                     scene_files_after("display")) >= 8);
}

TEST_CASE("bounds hold for what the optics do") {
  CHECK(check_bounds(shipped("sim-8x8-built"), {sim::EffectGroup::optics}, scene_files_after("star")) >= 7);
}

TEST_CASE("bounds hold for what the detector does") {
  CHECK(check_bounds(shipped("sim-8x8-detector"), {sim::EffectGroup::detector, sim::EffectGroup::electronics},
                     scene_files_after("star")) >= 7);
}

TEST_CASE("bounds hold for what wide cones do") {
  CHECK(check_bounds(wide(), {sim::EffectGroup::optics}, scene_files_after("text")) >= 3);
}

TEST_CASE("bounds hold for what a relief hides of itself") {
  const test::TemporaryFolder folder;
  const std::string file = (folder.path() / "steps.toml").string();
  std::ofstream(file) << "[[surface]]\nshape = \"relief\"\npicture = \"text\"\nheights = \"phantom\"\n"
                         "resolution = [64, 64]\nrelief_mm = 3\n";
  CHECK(check_bounds(shipped("sim-8x8"), {sim::EffectGroup::scene}, {file}) == (whole_grid ? 4 : 2));
}

// What nothing calls for changes nothing but how light is rendered to its tolerance.

TEST_CASE("what nothing calls for changes nothing before an eye as drawn") {
  check_uncalled(shipped("sim-8x8"), 1);
}

TEST_CASE("what nothing calls for changes nothing before an eye as built") {
  check_uncalled(shipped("sim-8x8-built"), 2);
}

TEST_CASE("what nothing calls for changes nothing before an honest detector") {
  check_uncalled(shipped("sim-8x8-detector"), 0);
}
