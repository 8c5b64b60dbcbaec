#include "studies/accuracy_and_time/conventional_figures.hpp"

#include <utility>

#include "firmware/eye/conventional_eye.hpp"
#include "firmware/eye/scene_choice.hpp"
#include "firmware/eye/simulated_board.hpp"

namespace compueye::firmware {
namespace {

hal::Result<PictureQuality> quality_on(const Board& noisy, const EvaluationScene& scene) {
  const auto shown = choose_scene(noisy, {scene.name, scene.seed, std::nullopt});
  if (!shown) return tl::unexpected(shown.error());
  const auto picture = conventional_picture(noisy, *shown, scene.seed);
  if (!picture) return tl::unexpected(picture.error());
  return quality_of(*picture, scene.truth);
}

}  // namespace

hal::Result<std::vector<QualitySummary>> conventional_figures(const Board& board,
                                                              const std::vector<EvaluationScene>& scenes,
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
        return hal::fail(hal::ErrorCode::interrupted, board.name, "stopped before anything was measured");
      }
      auto quality = quality_on(noisy, scene);
      if (!quality) return tl::unexpected(std::move(quality.error()));
      pictures.push_back(*quality);
    }
    figures.push_back(summarise(pictures));
  }
  return figures;
}

}  // namespace compueye::firmware
