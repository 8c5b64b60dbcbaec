#pragma once

#include "firmware/app/option_list.hpp"
#include "firmware/calibration/lights.hpp"

namespace compueye::firmware {

/// --light, --monitor and --window: what puts pictures before an eye.
void add_light_options(OptionList& options, LightWanted& light);

}  // namespace compueye::firmware
