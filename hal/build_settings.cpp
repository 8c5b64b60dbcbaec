#include "hal/build_settings.hpp"

#include <string>
#include <string_view>

#include "hal/field_range.hpp"
#include "hal/try.hpp"

namespace compueye::hal {

Result<void> BuildSettings::validate() const {
  TRY(expect_within("build.pose_rms_deg", pose_rms_deg, 0.0, 10.0));
  TRY(expect_within("build.apex_rms_mm", apex_rms_mm, 0.0, 1.0));
  TRY(expect_within("build.acceptance_spread", acceptance_spread, 0.0, 0.3));
  TRY(expect_within("build.edge_order", edge_order, 1.0, 64.0));
  TRY(expect_within("build.coma", coma, 0.0, 0.5));
  TRY(expect_within("build.lens_diameter_mm", lens_diameter_mm, 0.0, 100.0));
  TRY(expect_within("build.refractive_index", refractive_index, 1.0, 2.5));
  TRY(expect_within("build.dust_share", dust_share, 0.0, 1.0));
  TRY(expect_within("build.dust_loss", dust_loss, 0.0, 1.0));
  TRY(expect_within("build.crosstalk", crosstalk, 0.0, 0.5));
  TRY(expect_within("build.gain_spread", gain_spread, 0.0, 0.5));
  TRY(expect_within("build.offset_spread_lsb", offset_spread_lsb, 0.0, 4096.0));
  return expect_within("build.vignetting", vignetting, 0.0, 8.0);
}

}  // namespace compueye::hal
