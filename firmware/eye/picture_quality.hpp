#pragma once

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

[[nodiscard]] inline Value value_of(const std::optional<PictureQuality>& q) {
  return q ? Value(Figures{{"nmse", q->nmse}, {"psnr_db", q->psnr_db}, {"ssim", q->ssim}}) : Value();
}

}  // namespace compueye::firmware
