#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "firmware/app/command.hpp"
#include "firmware/eye/board.hpp"
#include "firmware/eye/planned_eye.hpp"
#include "firmware/eye/scene/scene_choice.hpp"
#include "firmware/eye/simulated_board.hpp"
#include "firmware/files/atomic_file.hpp"
#include "firmware/files/npy.hpp"
#include "firmware/files/png.hpp"
#include "firmware/text/number_text.hpp"
#include "firmware/text/table.hpp"
#include "hal/try.hpp"
#include "sim/effects/effect.hpp"
#include "sim/plan/plan.hpp"
#include "sim/simulated_eye.hpp"
#include "studies/effects/effect_gallery.hpp"

namespace compueye::firmware {
namespace {

using hal::Result;

/// What `compueye simulate` was asked for.
struct SimulateRequest {
  std::string board;
  SceneChoice scene;
  std::string out;  ///< y.npy
  std::int64_t frames = 1;
  std::uint64_t seed = 0;  ///< of the noise
  Overrides overrides;     ///< distance
  bool noise_free = false;
  bool codes = false;
  std::string truth;
  std::string weights;
  std::string png;      ///< the first frame's samples where their ommatidia are
  std::string gallery;  ///< a sheet of what each effect changes
  bool explain = false;
};

Result<void> check(const SimulateRequest& o) {
  TRY(need(o.frames >= 1 && o.frames <= 1'000'000, "--frames", fmt::format("is {}, expected 1 to 1000000", o.frames)));
  return need(!o.out.empty() || !o.truth.empty() || !o.png.empty() || !o.gallery.empty() || o.explain, "--out",
              "is missing: name the .npy file for the samples, for example --out y.npy");
}

/// A black picture's NMSE is 1: how much larger a bound is says nothing about a reconstruction.
std::string nmse_text(double nmse) {
  return nmse < 1.0 ? significant(nmse, 2) : "1 or more";
}

/// Which effects are simulated and why: for programs, and as a table.
class Explanation {
 public:
  Explanation(const sim::Plan& plan, double frames);

  Value::List list;
  Table table{{{"effect", Align::left},
               {"called for by", Align::left},
               {"at most, LSB", Align::right},
               {"NMSE", Align::right},
               {"decision", Align::left},
               {"time, about", Align::right}}};

 private:
  [[nodiscard]] double seconds_of(const sim::PlannedEffect& e) const {
    return e.on() ? e.cost.set_up_s + frames_ * e.cost.frame_s : 0.0;
  }

  double frames_;
};

Explanation::Explanation(const sim::Plan& plan, double frames) : frames_(frames) {
  double whole = 0.0;
  for (const sim::PlannedEffect& e : plan.effects) whole += seconds_of(e);
  for (const sim::PlannedEffect& e : plan.effects) {
    const double share = whole > 0.0 ? seconds_of(e) / whole : 0.0;
    const bool called = !e.called_for_by.empty();
    list.push_back(Figures{{"name", std::string(e.effect->name)},
                           {"group", std::string(name(e.effect->group))},
                           {"on", e.on()},
                           {"decision", std::string(name(e.decision))},
                           {"called_for_by", e.called_for_by},
                           {"bound_lsb", e.bound_lsb},
                           {"nmse", e.nmse},
                           {"time_share", share}});
    table.add({std::string(e.effect->name), called ? e.called_for_by : "-", called ? significant(e.bound_lsb, 2) : "",
               called ? nmse_text(e.nmse) : "", std::string(name(e.decision)),
               e.on() ? fmt::format("{:.0f} %", 100.0 * share) : ""});
  }
}

/// What the plan adds up to, in a sentence.
std::string sum_of(const sim::Plan& plan) {
  if (plan.noise_lsb == 0.0) return "There is no noise, which is all that anything could hide behind.\n";
  const std::string measured = plan.sensitivity.measured ? "measured for this eye" : "of the paper's small eye";
  return fmt::format(
      "Noise is {} LSB of {} and makes an NMSE of {} by estimate (sensitivity {}); what is left out adds at most {} % "
      "of "
      "that.\n",
      significant(plan.noise_lsb, 2), significant(plan.signal_rms_lsb, 3), nmse_text(plan.noise_nmse), measured,
      significant(100.0 * plan.left_out_nmse / plan.noise_nmse, 2));
}

/// All frames after each other, M values each.
struct Samples {
  std::vector<float> values;
  std::vector<float> weights;
  std::uint64_t saturated_frames = 0;
};

void append(const hal::SampleBlock& block, const Board& board, bool codes, Samples& samples) {
  const double lsb = board.sensor.lsb(), dark = board.sensor.dark_level_lsb;
  for (std::size_t c = 0; c < block.codes.size(); ++c) {
    const bool valid = block.valid[c] != 0;
    const double code = block.codes[c];
    const double value = codes ? code : (code - dark) * lsb;
    samples.values.push_back(valid ? static_cast<float>(value) : std::numeric_limits<float>::quiet_NaN());
    samples.weights.push_back(valid ? 1.0F : 0.0F);
  }
  if (block.flags.saturated) ++samples.saturated_frames;
}

using Eye = std::unique_ptr<sim::SimulatedEye>;

Result<Eye> eye_of(const Board& board, const sim::Scene& scene, const SimulateRequest& o, Session& session,
                   hal::Clock& clock) {
  sim::Scene seen = scene;
  for (const sim::Effect* effect : sim::effects()) {
    if (o.noise_free && effect->noise) seen.effects[std::string(effect->name)] = sim::Forced::off;
  }
  sim::SimulatedEyeSettings settings = simulated_eye_settings(board, std::move(seen), o.seed);
  settings.planning.budget.rounded = o.codes || !o.noise_free;
  auto eye = planned_eye(board, std::move(settings), clock, session.progress());
  session.end_progress();
  return eye;
}

Result<Samples> take(const Board& board, sim::SimulatedEye& eye, const SimulateRequest& o, Session& session) {
  TRY(eye.start());
  std::int64_t f = 0;
  eye.watch(
      [&f, frames = static_cast<double>(o.frames), progress = session.progress()](std::string_view, double share) {
        return progress("samples", static_cast<double>(f) + share, frames);
      });
  const double lsb = board.sensor.lsb(), dark = board.sensor.dark_level_lsb;
  Samples samples;
  for (; f < o.frames; ++f) {
    const std::size_t begin = samples.values.size();
    const auto block = eye.read(0);
    TRY(session.check_stop());
    append(TRY(block), board, o.codes, samples);
    if (!o.noise_free || o.codes) continue;
    const std::span<const double> levels = eye.levels_lsb(static_cast<std::uint64_t>(f));
    for (std::size_t c = 0; c < levels.size(); ++c) {
      float& value = samples.values[begin + c];
      if (!std::isnan(value)) value = static_cast<float>((levels[c] - dark) * lsb);
    }
  }
  eye.watch({});
  session.end_progress();
  return samples;
}

Result<void> write(const Samples& samples, const Board& board, const SimulateRequest& o) {
  std::vector<std::int64_t> shape{board.eye.ommatidia()};
  if (o.frames > 1) shape.insert(shape.begin(), o.frames);
  if (!o.out.empty()) TRY(write_npy(o.out, shape, std::span<const float>(samples.values)));
  if (o.weights.empty()) return {};
  return write_npy(o.weights, shape, std::span<const float>(samples.weights));
}

Result<void> write_truth(const Board& board, const sim::Scene& scene, const SimulateRequest& o) {
  if (o.truth.empty()) return {};
  std::vector<std::int64_t> shape{board.object.rows, board.object.cols};
  const std::int64_t frames = scene.still() ? 1 : o.frames;
  if (frames > 1) shape.insert(shape.begin(), frames);
  std::vector<float> pixels;
  for (std::int64_t frame = 0; frame < frames; ++frame) {
    const hal::Image truth = TRY(truth_of_frame(board, scene, static_cast<std::uint64_t>(frame)));
    pixels.insert(pixels.end(), truth.pixels.begin(), truth.pixels.end());
  }
  return write_npy(o.truth, shape, std::span<const float>(pixels));
}

/// The first frame as the eye's grid: black is no light, white the largest sample, what tells nothing is black. Small
/// grids are drawn in squares.
Result<void> write_picture(const Samples& samples, const Board& board, const SimulateRequest& o) {
  if (o.png.empty()) return {};
  constexpr int least_side = 160;
  const int rows = board.eye.rows, cols = board.eye.columns;
  const int zoom = std::max(1, (least_side + std::max(rows, cols) - 1) / std::max(rows, cols));
  const std::span<const float> frame(samples.values.data(), static_cast<std::size_t>(board.eye.ommatidia()));
  float largest = 0.0F;
  for (const float value : frame) largest = std::isnan(value) ? largest : std::max(largest, value);
  hal::Image picture(rows * zoom, cols * zoom);
  for (int r = 0; r < picture.rows && largest > 0.0F; ++r) {
    for (int c = 0; c < picture.cols; ++c) {
      picture.at(r, c) = frame[static_cast<std::size_t>(r / zoom * cols + c / zoom)] / largest;
    }
  }
  return write_png(o.png, picture);
}

Figures report_of(const Board& board, const sim::Scene& scene, const sim::Plan& plan, const Samples& samples,
                  const SimulateRequest& o) {
  const Explanation effects(plan, static_cast<double>(o.frames));
  Figures f{{"board", board.name},
            {"scene", scene.name},
            {"frames", o.frames},
            {"channels", board.eye.ommatidia()},
            {"seed", o.seed},
            {"distance_mm", board.object.distance_mm},
            {"unit", o.codes ? "code" : "fully seen white pixel"},
            {"lsb", board.sensor.lsb()},
            {"noise_sigma", o.noise_free ? 0.0 : board.sensor.noise_sigma()},
            {"dead_channels", board.sensor.dead.size()},
            {"saturated_frames", samples.saturated_frames},
            {"effects", effects.list},
            {"noise_lsb", plan.noise_lsb},
            {"noise_nmse", plan.noise_nmse},
            {"left_out_lsb", plan.left_out_lsb},
            {"left_out_nmse", plan.left_out_nmse},
            {"sensitivity_measured", plan.sensitivity.measured},
            {"samples_file", o.out},
            {"truth_file", o.truth}};
  if (o.explain) f.say(effects.table.text() + sum_of(plan));
  if (!o.out.empty()) {
    f.tell("{samples_file}: {frames:# frame} of {channels} samples of {board} in front of {scene}\n");
  }
  return f.tell(
      "[saturated channels in {saturated_frames:# frame}\n]"
      "[NaN for {dead_channels:# dead channel}; --weights writes the weights that leave them out\n]");
}

/// Writes the samples of a board's simulated eye: float32, (M,) for one frame and (frames, M) for more, by ommatidium,
/// in units of one fully seen white pixel with dark level and LSB taken out; channels that tell nothing are NaN.
Result<void> simulate(const SimulateRequest& request, Session& session) {
  TRY(check(request));
  Board board = TRY(load_board(request.board));
  TRY(request.overrides.apply(board));
  const sim::Scene scene = TRY(choose_scene(board, request.scene));
  for (const std::string& file : {request.out, request.truth, request.weights, request.png, request.gallery})
    TRY(try_output(file));
  hal::VirtualClock clock;
  const Eye eye = TRY(eye_of(board, scene, request, session, clock));
  const Samples samples = TRY(take(board, *eye, request, session));
  if (!request.gallery.empty()) {
    const GalleryRequest wanted{request.gallery, static_cast<std::uint64_t>(request.frames) - 1, request.seed};
    TRY(write_effect_gallery(board, scene, wanted, session.progress()));
    session.end_progress();
  }
  TRY(session.seal());
  TRY(write(samples, board, request));
  TRY(write_truth(board, scene, request));
  TRY(write_picture(samples, board, request));
  return session.print(report_of(board, scene, eye->plan(0), samples, request));
}

Action declare(OptionList& options) {
  auto o = std::make_shared<SimulateRequest>();
  options.board(o->board).required();
  options.scene(o->scene, o->seed);
  options.add("--out", o->out, ".npy file for the samples, (M,) or (frames, M)").output();
  options.add("--frames", o->frames, "how many (default 1)");
  options.settings("simulate", o->overrides);
  options.add("--scene-distance", o->scene.distance_mm, "of the scene alone, mm from the lens tip").where(length_mm());
  options.flag("--noise-free", o->noise_free,
               "exact signals: no noise of photons and electronics, no rounding (with --codes: rounded)");
  options.flag("--codes", o->codes, "raw codes instead of corrected samples");
  options
      .add("--truth", o->truth,
           ".npy file for the scene on the object plane's pixels, (rows, columns); of each frame if something moves")
      .output();
  options.add("--weights", o->weights, ".npy file for weights shaped like the samples, 0 = tells nothing").output();
  options.add("--png", o->png, ".png file for the first frame's samples as the eye's grid, the largest white").output();
  options.add("--gallery", o->gallery, ".png sheet with a row for every effect that is called for: what it changes")
      .output();
  options.flag("--explain", o->explain, "print which effects are on and off and why; works without --out too");
  options.json("print one object and nothing else on stdout");
  return action_of(o, simulate);
}

std::string footer() {
  return "Samples are in units of one fully seen white pixel, corrected for dark level and LSB. Dead channels "
         "are NaN.\n\nBuilt-in scenes:\n" +
         built_in_scene_help() +
         "\nExamples:\n"
         "  compueye simulate --board boards/sim-8x8 --scene fig2 --out y.npy --truth x.npy\n"
         "  compueye simulate --board boards/sim-80x80 --frames 10 --seed 3 --out y.npy --explain";
}

}  // namespace

extern const Command simulate_command;
const Command simulate_command{"simulate", "samples of a board's simulated eye", OnSignal::gives_up, declare, footer};

}  // namespace compueye::firmware
