#include "studies/accuracy_and_time/scenes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "firmware/eye/scene/scene_choice.hpp"
#include "firmware/eye/simulated_board.hpp"
#include "hal/sample_block.hpp"
#include "hal/sample_source.hpp"
#include "hal/try.hpp"
#include "sim/pictures/built_in_scenes.hpp"
#include "sim/render/drawn_signals.hpp"
#include "sim/scene/scene_truth.hpp"
#include "sim/simulation.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::Result;

Result<void> check_name(const std::string& name) {
  std::vector<std::string_view> varied;
  for (const sim::BuiltInScene& scene : sim::built_in_scenes()) {
    if (scene.varies) varied.push_back(scene.name);
    if (scene.name != name || scene.varies) continue;
    return hal::fail(ErrorCode::usage, "--scenes",
                     fmt::format("has {}, of which not every seed is another drawing; dots are like fig2", name));
  }
  if (std::find(varied.begin(), varied.end(), name) != varied.end()) return {};
  return hal::fail(ErrorCode::usage, "--scenes",
                   fmt::format("has '{}', expected built-in scenes, which draw another picture for every seed: {}",
                               name, fmt::join(varied, ", ")));
}

Result<std::vector<double>> signals_through(const recon::Response* measured, const Board& board,
                                            const sim::Scene& scene) {
  if (measured == nullptr) return sim::drawn_signals(board.eye, board.object, scene);
  const hal::Image truth = TRY(sim::scene_truth(scene, board.object));
  const std::vector<double> x(truth.pixels.begin(), truth.pixels.end());
  std::vector<double> signals(static_cast<std::size_t>(measured->rows()));
  measured->forward(x, signals);
  return signals;
}

Result<EvaluationScene> drawn(const Board& board, const std::string& name, std::uint64_t seed, bool moving,
                              const recon::Response* measured) {
  const sim::Scene scene = TRY(choose_scene(board, {name, seed, std::nullopt}));
  EvaluationScene drawing{
      name, seed, TRY(sim::scene_truth(scene, board.object)), TRY(signals_through(measured, board, scene)), {}};
  for (std::size_t left = moving_frames; moving && left > 0; --left) {
    sim::Scene earlier = scene;
    earlier.surfaces.front().bands = {before_arrival(scene.surfaces.front().picture(), left)};
    drawing.moving.push_back(TRY(signals_through(measured, board, earlier)));
  }
  return drawing;
}

/// Signals of frame `frame` of a sequence. The piece waits outside until it moves.
const std::vector<double>& signals_of(const EvaluationScene& scene, Motion motion, std::size_t frame) {
  const std::size_t left = sequence_frames - 1 - frame;
  if (motion != Motion::sprite || left == 0) return scene.signals;
  return scene.moving[moving_frames - std::min(left, moving_frames)];
}

/// In the dark, to be given signals.
Result<sim::Simulation> sensor_alone(const Board& board, std::uint64_t seed) {
  auto eye = simulated_eye_settings(board, sim::scene_on(board.object, "dark", hal::Image(1, 1)), seed);
  return sim::Simulation::create(std::move(eye.board), std::move(eye.scenes.front()), seed);
}

}  // namespace

std::vector<std::string> usual_scenes(const Board& board) {
  constexpr int least = 32;
  if (std::min(board.object.rows, board.object.cols) < least) return {"dots"};
  return {"line-art", "phantom", "bars"};
}

Result<std::vector<EvaluationScene>> make_evaluation_scenes(const Board& board, const std::vector<std::string>& names,
                                                            bool moving, const recon::Progress& progress,
                                                            const recon::Response* measured) {
  for (const std::string& name : names) TRY(check_name(name));
  std::vector<EvaluationScene> scenes;
  while (scenes.size() < evaluation_scenes) {
    if (!progress("evaluation scenes", static_cast<double>(scenes.size()), static_cast<double>(evaluation_scenes))) {
      return hal::fail(ErrorCode::interrupted, board.name, "stopped before anything was measured");
    }
    const std::size_t i = scenes.size();
    scenes.push_back(TRY(drawn(board, names[i % names.size()], first_evaluation_seed + i, moving, measured)));
  }
  return scenes;
}

Board with_noise(const Board& board, double times) {
  constexpr double rounding = 1.0 / 12.0;  // variance of a code, in LSB squared
  Board noisy = board;
  const double own = board.sensor.read_noise_lsb * board.sensor.read_noise_lsb + rounding;
  noisy.sensor.read_noise_lsb = std::sqrt(std::max(0.0, own * times * times - rounding));
  return noisy;
}

Result<std::vector<FrameSequence>> take_frames(const Board& board, const std::vector<EvaluationScene>& scenes,
                                               const std::vector<std::uint8_t>& sees, const NoiseLevel& level,
                                               Motion motion) {
  const Board noisy = with_noise(board, level.times);
  const auto channels = static_cast<std::size_t>(board.eye.ommatidia());
  hal::SourceDescription description;
  description.channels = board.eye.ommatidia();
  description.bits = board.sensor.bits;
  description.ommatidium_of_channel.resize(channels);
  std::iota(description.ommatidium_of_channel.begin(), description.ommatidium_of_channel.end(), 0);
  Correction correction = TRY(Correction::create(correction_settings(noisy, sees), description));
  std::vector<std::uint8_t> valid(channels, 1);
  for (const int dead : board.sensor.dead) valid[static_cast<std::size_t>(dead)] = 0;
  std::vector<std::int32_t> codes(channels);
  std::vector<FrameSequence> sequences;
  for (const EvaluationScene& scene : scenes) {
    FrameSequence& sequence = sequences.emplace_back();
    sim::Simulation sensor = TRY(sensor_alone(noisy, scene.seed));
    for (std::size_t f = motion == Motion::none ? sequence_frames - 1 : 0; f < sequence_frames; ++f) {
      hal::SampleBlock block;
      block.flags.saturated = sensor.codes_of(signals_of(scene, motion, f), f, codes);
      block.codes = codes;
      block.valid = valid;
      block.bits = board.sensor.bits;
      EvaluationFrame frame{std::vector<float>(channels), std::vector<float>(channels)};
      const CorrectionReport report = correction.apply(block, frame.y, frame.weights);
      if (!report.usable) {
        return hal::fail(ErrorCode::mismatch, board.place("sensor", "max_missing_share"),
                         fmt::format("a frame of {} lacks {} channels, {} of them saturated, and would be dropped",
                                     scene.name, report.masked, report.saturated));
      }
      sequence.push_back(std::move(frame));
    }
  }
  return sequences;
}

Result<std::vector<QualitySummary>> conventional_figures(const Board& board, const std::vector<EvaluationScene>& scenes,
                                                         const std::vector<NoiseLevel>& levels,
                                                         const recon::Progress& progress) {
  std::vector<QualitySummary> figures;
  if (!conventional_board(board)) return figures;
  for (const NoiseLevel& level : levels) {
    const Board noisy = with_noise(board, level.times);
    std::vector<PictureQuality> pictures;
    for (const EvaluationScene& scene : scenes) {
      const auto done = static_cast<double>(figures.size() * scenes.size() + pictures.size());
      if (!progress("conventional eye", done, static_cast<double>(levels.size() * scenes.size()))) {
        return hal::fail(ErrorCode::interrupted, board.name, "stopped before anything was measured");
      }
      const sim::Scene shown = TRY(choose_scene(noisy, {scene.name, scene.seed, std::nullopt}));
      pictures.push_back(TRY(quality_of(TRY(conventional_picture(noisy, shown, scene.seed)), scene.truth)));
    }
    figures.push_back(summarise(pictures));
  }
  return figures;
}

hal::Image before_arrival(const hal::Image& scene, std::size_t frames) {
  constexpr int pieces = 4, steps = 80;
  const int side = std::max(std::min(scene.rows, scene.cols) / pieces, 1);
  const int top = (scene.rows - side) / 2, left = (scene.cols - side) / 2;
  const int shift = std::max(scene.cols / steps, 1) * static_cast<int>(frames);
  hal::Image picture = scene;
  for (int row = top; row < top + side; ++row) {
    for (int col = left; col < left + side; ++col) picture.at(row, col) = 0.0F;
  }
  for (int row = top; row < top + side; ++row) {
    for (int col = left; col < std::min(left + side, scene.cols - shift); ++col) {
      picture.at(row, col + shift) = scene.at(row, col);
    }
  }
  return picture;
}

}  // namespace compueye::firmware
