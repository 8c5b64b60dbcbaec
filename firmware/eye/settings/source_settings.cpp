#include <cstdint>

#include "firmware/eye/settings/field.hpp"
#include "firmware/eye/settings/setting.hpp"

namespace compueye::firmware {

std::vector<Setting> source_settings() {
  using V = SettingValue;
  return {
      field<&Board::source, &SourceSettings::kind>({.section = "source",
                                                    .key = "kind",
                                                    .type = SettingType::choice,
                                                    .choices = {source_kind_names.begin(), source_kind_names.end()},
                                                    .required = true,
                                                    .meaning = "simulated, or an eye on USB or HID"}),
      field<&Board::source, &SourceSettings::serial>(
          {.section = "source",
           .key = "serial",
           .type = SettingType::identifier,
           .meaning = "which eye; left out, the first one there is on a cable, SIM0001 in a simulation"}),
      field<&Board::source, &SourceSettings::frame_rate_hz>({.section = "source",
                                                             .key = "frame_rate_hz",
                                                             .range = {0.001, 1e6},
                                                             .required = true,
                                                             .meaning = "frames the device takes in a second"}),
      field<&Board::source, &SourceSettings::fifo_frames>(
          {.section = "source",
           .key = "fifo_frames",
           .range = {1, 4096},
           .fallback = V{std::int64_t{4}},
           .meaning = "frames a simulated device can hold before it loses one"}),
      field<&Board::scene, &SceneSettings::name>(
          {.section = "scene",
           .key = "default",
           .fallback = V{std::string("line-art")},
           .meaning = "a built-in scene, or a PNG file (relative to the board's folder)"}),
      field<&Board::scene, &SceneSettings::frames_per_scene>(
          {.section = "scene",
           .key = "frames_per_scene",
           .range = {1, 1000000},
           .fallback = V{std::int64_t{30}},
           .meaning = "frames of each scene when the command line does not say"}),
  };
}

}  // namespace compueye::firmware
