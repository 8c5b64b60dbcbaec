#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "firmware/eye/board.hpp"
#include "firmware/operating_points/measured_points.hpp"
#include "hal/image.hpp"
#include "hal/result.hpp"
#include "recon/problem/response.hpp"
#include "recon/setup/factor.hpp"

namespace compueye::firmware {

/// Pictures that no rule was fitted on: docs/lambda-rule.md has seeds up to 5 and from 1001 on, boards show seed 0.
inline constexpr std::uint64_t first_evaluation_seed = 2001;
inline constexpr std::size_t evaluation_scenes = 12;

/// Frames of a sequence, the judged one last, and how many of them a piece of the scene moves in (Motion::sprite).
inline constexpr std::size_t sequence_frames = 12;
inline constexpr std::size_t moving_frames = 6;

/// A drawing in front of the eye and the light that reaches each ommatidium: through the simulator's optics or, where
/// the eye's rows were measured and nothing else is known of its optics, as these say.
struct EvaluationScene {
  std::string name;
  std::uint64_t seed = 0;
  hal::Image truth;
  std::vector<double> signals;              ///< M, without noise
  std::vector<std::vector<double>> moving;  ///< of the frames in which its piece moves; empty when not asked for
};

/// Corrected samples of one scene.
struct EvaluationFrame {
  std::vector<float> y;
  std::vector<float> weights;
};

/// The frames of one scene in order, the judged one last.
using FrameSequence = std::vector<EvaluationFrame>;

/// The built-in scenes that suit the eye: drawings, heads and bars where there are pixels enough to draw on (at least
/// 32 x 32), single dots otherwise.
[[nodiscard]] std::vector<std::string> usual_scenes(const Board& board);

/// Twelve scenes, the names in turn, each with a seed of its own, and with `moving` the frames before them. `measured`:
/// null for an eye as drawn. Errors:
/// usage for a scene that is no built-in one or has not a drawing for every seed (fig2); those of the optics;
/// interrupted.
[[nodiscard]] hal::Result<std::vector<EvaluationScene>> make_evaluation_scenes(
    const Board& board, const std::vector<std::string>& names, bool moving, const recon::Progress& progress,
    const recon::Response* measured = nullptr);

/// What the board's sensor makes of every scene at this noise, and its correction of the codes. The judged frame is the
/// same for every motion. `sees` as in CorrectionSettings. Error mismatch when a frame would be dropped.
[[nodiscard]] hal::Result<std::vector<FrameSequence>> take_frames(const Board& board,
                                                                  const std::vector<EvaluationScene>& scenes,
                                                                  const std::vector<std::uint8_t>& sees,
                                                                  const NoiseLevel& level, Motion motion);

/// What the conventional eye makes of the scenes at each noise level; nothing for a lattice that has none. Errors:
/// those of conventional_picture(); interrupted.
[[nodiscard]] hal::Result<std::vector<QualitySummary>> conventional_figures(const Board& board,
                                                                            const std::vector<EvaluationScene>& scenes,
                                                                            const std::vector<NoiseLevel>& levels,
                                                                            const recon::Progress& progress);

/// The scene so many frames before its piece is in its place: a square a quarter as wide as the picture, from its
/// middle, an eightieth of the width further right for each frame (at least a pixel), and black where it will be.
[[nodiscard]] hal::Image before_arrival(const hal::Image& scene, std::size_t frames);

/// The board with a sensor whose noise of a sample, rounding included, is so many times its own.
[[nodiscard]] Board with_noise(const Board& board, double times);

}  // namespace compueye::firmware
