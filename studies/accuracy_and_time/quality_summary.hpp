#pragma once

#include <span>

#include "firmware/eye/picture_quality.hpp"

namespace compueye::firmware {

/// How good the pictures of several scenes are: on the mean, and what nine of ten scenes reach (nearest rank on the bad
/// side: the 90th percentile of NMSE, the 10th of PSNR and SSIM).
struct QualitySummary {
  PictureQuality mean;
  PictureQuality nine_in_ten;
};

/// Of at least one picture.
[[nodiscard]] QualitySummary summarise(std::span<const PictureQuality> pictures);

}  // namespace compueye::firmware
