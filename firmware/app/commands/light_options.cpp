#include "firmware/app/commands/light_options.hpp"

namespace compueye::firmware {

void add_light_options(OptionList& options, LightWanted& light) {
  options
      .add("--light", light.kind,
           "what shows the patterns: " + choices(light_names()) + " (default: sim for a simulated eye, else display)")
      .among(light_names());
  options.add("--monitor", light.monitor, "number of the display's monitor, from 0");
  options.flag("--window", light.in_window, "a window on it instead of all of it");
}

}  // namespace compueye::firmware
