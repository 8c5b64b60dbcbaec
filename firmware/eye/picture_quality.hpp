#pragma once

#include <algorithm>
#include <optional>

#include "firmware/text/figures.hpp"
#include "hal/image.hpp"
#include "hal/result.hpp"
#include "hal/try.hpp"
#include "recon/metrics.hpp"

namespace compueye::firmware {

/// How near a picture comes to the truth; see recon/metrics.hpp.
struct PictureQuality {
  double nmse = 0.0;
  double psnr_db = 0.0;
  double ssim = 0.0;
};

/// Errors: those of the metrics.
[[nodiscard]] inline hal::Result<PictureQuality> quality_of(const recon::PictureView& picture,
                                                            const hal::Image& truth) {
  return PictureQuality{TRY(recon::nmse(picture, truth)), TRY(recon::psnr(picture, truth)),
                        TRY(recon::ssim(picture, truth))};
}

[[nodiscard]] inline bool is_black(const hal::Image& truth) {
  return std::all_of(truth.pixels.begin(), truth.pixels.end(), [](float v) { return v == 0.0F; });
}

/// Nothing of a black truth: nothing is near it or far from it, errors have no share of it.
using QualityIfLit = std::optional<PictureQuality>;
[[nodiscard]] inline hal::Result<QualityIfLit> quality_if_lit(const recon::PictureView& picture,
                                                              const hal::Image& truth) {
  if (is_black(truth)) return QualityIfLit();
  return QualityIfLit(TRY(quality_of(picture, truth)));
}

[[nodiscard]] inline Value value_of(const std::optional<PictureQuality>& q) {
  return q ? Value(Figures{{"nmse", q->nmse}, {"psnr_db", q->psnr_db}, {"ssim", q->ssim}}) : Value();
}

}  // namespace compueye::firmware
