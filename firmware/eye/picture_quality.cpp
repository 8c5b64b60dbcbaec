#include "firmware/eye/picture_quality.hpp"

namespace compueye::firmware {

hal::Result<PictureQuality> quality_of(const recon::PictureView& picture, const hal::Image& truth) {
  const auto nmse = recon::nmse(picture, truth);
  if (!nmse) return tl::unexpected(nmse.error());
  const auto psnr = recon::psnr(picture, truth);
  if (!psnr) return tl::unexpected(psnr.error());
  const auto ssim = recon::ssim(picture, truth);
  if (!ssim) return tl::unexpected(ssim.error());
  return PictureQuality{*nmse, *psnr, *ssim};
}

}  // namespace compueye::firmware
