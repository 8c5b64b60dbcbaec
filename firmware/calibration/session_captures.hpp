#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "calib/emva1288.hpp"
#include "calib/estimate/captures.hpp"
#include "calib/eye_file/eye_file.hpp"
#include "hal/eye_geometry.hpp"

namespace compueye::firmware {

/// What a session took, as the estimators want it.
struct SessionCaptures {
  calib::Captures captures;
  std::vector<calib::LightSeries> series;  ///< frame by frame: dark, black and white all over
};

/// Of a session that has ended. Patterns are drawn anew from what each capture says of itself. Times are the device's,
/// in seconds; where its clock began anew they go on an hour later, so that nothing is interpolated across. Errors:
/// those of the file and of picture_of(); bad_format (a stage that is none).
[[nodiscard]] hal::Result<SessionCaptures> session_captures(const calib::EyeFile& file,
                                                            const calib::StoredSession& session, double exposure_s);

/// Noise as the session itself shows it, where it can tell: read noise by the median channel in the dark, electrons by
/// the photon transfer. `unit_lsb`: LSB that a fully seen white pixel gives as drawn.
[[nodiscard]] calib::CodeNoise code_noise(const calib::SensorNoise& sensor, double unit_lsb, double saturated_lsb);

}  // namespace compueye::firmware
