#include "hal/build_settings.hpp"

#include <string>
#include <string_view>

#include "hal/try.hpp"

namespace compueye::hal {
namespace {

Result<void> within(std::string_view field, double value, double lo, double hi) {
  if (value >= lo && value <= hi) return {};
  return fail(ErrorCode::out_of_range, "build." + std::string(field),
              "is " + std::to_string(value) + ", expected " + std::to_string(lo) + " to " + std::to_string(hi));
}

}  // namespace

Result<void> BuildSettings::validate() const {
  TRY(within("pose_rms_deg", pose_rms_deg, 0.0, 10.0));
  TRY(within("apex_rms_mm", apex_rms_mm, 0.0, 1.0));
  TRY(within("acceptance_spread", acceptance_spread, 0.0, 0.3));
  TRY(within("edge_order", edge_order, 1.0, 64.0));
  TRY(within("coma", coma, 0.0, 0.5));
  TRY(within("lens_diameter_mm", lens_diameter_mm, 0.0, 100.0));
  TRY(within("refractive_index", refractive_index, 1.0, 2.5));
  TRY(within("dust_share", dust_share, 0.0, 1.0));
  TRY(within("dust_loss", dust_loss, 0.0, 1.0));
  TRY(within("crosstalk", crosstalk, 0.0, 0.5));
  TRY(within("gain_spread", gain_spread, 0.0, 0.5));
  TRY(within("offset_spread_lsb", offset_spread_lsb, 0.0, 4096.0));
  return within("vignetting", vignetting, 0.0, 8.0);
}

}  // namespace compueye::hal
