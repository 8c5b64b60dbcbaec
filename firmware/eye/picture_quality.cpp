#include "firmware/eye/picture_quality.hpp"

#include "hal/try.hpp"

namespace compueye::firmware {

hal::Result<PictureQuality> quality_of(const recon::PictureView& picture, const hal::Image& truth) {
  return PictureQuality{TRY(recon::nmse(picture, truth)), TRY(recon::psnr(picture, truth)),
                        TRY(recon::ssim(picture, truth))};
}

}  // namespace compueye::firmware
