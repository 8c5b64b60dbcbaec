#pragma once

#include <cmath>
#include <cstdint>
#include <string_view>
#include <vector>

#include "sim/effects/effect_list.hpp"
#include "sim/scene/scene.hpp"

namespace compueye::test {

/// A board, a scene and a preview made by hand, and the effects' steps run on levels made by hand.
struct EffectRig {
  sim::EyeToSimulate board;
  sim::Scene scene;
  sim::Preview preview;

  /// An eye of `rows` x `columns` in front of an even grey sheet; every level the same.
  explicit EffectRig(int rows = 8, int columns = 8, double level_lsb = 1000.0) {
    board.eye.rows = rows;
    board.eye.columns = columns;
    board.eye.interommatidial_rad = 0.02;
    board.eye.acceptance_rad = 0.14;
    board.frame_rate_hz = 100.0;
    hal::Image grey(1, 1);
    grey.pixels = {0.5F};
    scene = sim::scene_on(board.object, "grey", grey);
    look_at(std::vector<double>(static_cast<std::size_t>(rows * columns), level_lsb));
  }

  /// Preview's figures of these levels, as far as they follow from them.
  void look_at(std::vector<double> levels) {
    preview = {};
    double squares = 0.0;
    for (const double level : levels) {
      preview.mean += level / static_cast<double>(levels.size());
      squares += level * level / static_cast<double>(levels.size());
      preview.largest = std::max(preview.largest, level);
    }
    preview.rms = std::sqrt(squares);
    preview.levels = std::move(levels);
  }

  [[nodiscard]] sim::Circumstances circumstances() const { return {board, scene, preview}; }
  [[nodiscard]] static const sim::Effect& effect(std::string_view name) { return *sim::effect_named(name).value(); }
  [[nodiscard]] std::string called(std::string_view name) const { return effect(name).calls_for(circumstances()); }
  [[nodiscard]] double bound(std::string_view name) const { return effect(name).bound(circumstances()); }

  /// Workings with these effects applied, beginning as a simulation's do.
  [[nodiscard]] sim::Workings workings(const std::vector<std::string_view>& names, std::uint64_t seed = 1) const {
    sim::Workings w;
    w.seed = seed;
    w.scene = sim::lit(scene);
    w.optics = sim::OpticsAsBuilt::drawn(board.eye);
    for (const std::string_view name : names) effect(name).apply(circumstances(), w);
    return w;
  }

  /// The preview's levels after these steps, in each of `frames` frames.
  [[nodiscard]] std::vector<std::vector<double>> play(const std::vector<std::string_view>& names, int frames = 1,
                                                      std::uint64_t seed = 1) const {
    const sim::Workings w = workings(names, seed);
    std::vector<std::vector<double>> played;
    std::vector<std::int32_t> stuck(preview.levels.size());
    for (int f = 0; f < frames; ++f) {
      std::vector<double>& levels = played.emplace_back(preview.levels);
      std::fill(stuck.begin(), stuck.end(), -1);
      sim::FrameInWork frame{static_cast<std::uint64_t>(f), f * board.period_s(), levels, stuck};
      for (const auto& step : w.steps) step->apply(frame);
      for (std::size_t m = 0; m < stuck.size(); ++m) levels[m] = stuck[m] >= 0 ? stuck[m] : levels[m];
    }
    return played;
  }

  /// Frame 0 alone.
  [[nodiscard]] std::vector<double> played(const std::vector<std::string_view>& names) const {
    return play(names).front();
  }

  /// Rms over channels and frames of what these steps change.
  [[nodiscard]] double change(const std::vector<std::string_view>& names, int frames = 1) const {
    double squares = 0.0;
    for (const auto& levels : play(names, frames)) {
      for (std::size_t m = 0; m < levels.size(); ++m) squares += std::pow(levels[m] - preview.levels[m], 2);
    }
    return std::sqrt(squares / static_cast<double>(frames) / static_cast<double>(preview.levels.size()));
  }
};

struct Moments {
  double mean = 0.0, variance = 0.0;
};

[[nodiscard]] inline Moments moments(const std::vector<double>& values) {
  Moments m;
  for (const double v : values) m.mean += v / static_cast<double>(values.size());
  for (const double v : values) m.variance += (v - m.mean) * (v - m.mean) / static_cast<double>(values.size() - 1);
  return m;
}

}  // namespace compueye::test
