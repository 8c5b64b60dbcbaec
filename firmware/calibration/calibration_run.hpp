#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calib/eye_file/eye_file.hpp"
#include "calib/session/session_machine.hpp"
#include "firmware/calibration/exposure_choice.hpp"
#include "hal/clock.hpp"
#include "hal/illuminator.hpp"
#include "hal/sample_source.hpp"

namespace compueye::firmware {

/// The bench that a session runs on. All of it outlives the session.
struct CalibrationBench {
  hal::SampleSource& eye;
  hal::Illuminator& light;
  hal::Clock& clock;                    ///< that of both
  ExposureControl* exposure = nullptr;  ///< where the eye allows it
};

/// Of the line that a session's configuration has where the exposure can be set.
inline constexpr std::string_view exposure_key = "exposure_ns";

/// Of a session whose eye allowed it to be set.
[[nodiscard]] std::optional<std::int64_t> exposure_of(const calib::Session& session);

struct CalibrationRequest {
  calib::SessionPlan plan;
  bool resume = false;
  bool give_up = false;       ///< a session that was cut off stays as it is, and a new one is begun
  double distance_mm = 0.0;   ///< of the light, from the lens tip
  std::string configuration;  ///< of eye and board, lines "key = value": what must not change within a session
  std::string program;        ///< name and version
  std::int64_t now_unix_s = 0;
};

/// Told after every frame; false ends the session, to be resumed.
using CalibrationWatch = std::function<bool(const calib::SessionProgress&)>;

/// Takes a session's captures into an eye file, each on the disk before the next picture shows, and ends the session.
/// Its id. Captures are in the order of ommatidia. A new session chooses its exposure, where that can be set; one that
/// goes on has that of before. An eye that is lost and found is shown its light anew.
///
/// Whatever ends it, the captures that were taken stay, and `resume` goes on after the last. Errors: those of
/// SessionMachine, of the eye, the light and the file; usage (the file holds a session that was cut off and is not to
/// be resumed, or none that could be), mismatch (to be resumed with another eye, configuration or plan), timeout (no
/// frame within ten seconds), interrupted (the watch said so).
[[nodiscard]] hal::Result<std::int64_t> run_calibration(const CalibrationRequest& request,
                                                        const CalibrationBench& bench, calib::EyeFile& file,
                                                        const CalibrationWatch& watch);

/// Takes what a schedule asks for, after the plan's warm-up and looks at the light, and keeps it nowhere. Errors: as
/// above, but those of the file.
[[nodiscard]] hal::Result<std::vector<calib::Capture>> take_captures(const calib::SessionPlan& plan,
                                                                     const std::vector<calib::Wanted>& schedule,
                                                                     const CalibrationBench& bench,
                                                                     const CalibrationWatch& watch);

}  // namespace compueye::firmware
