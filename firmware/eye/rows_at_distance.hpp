#pragma once

#include <cstdint>
#include <optional>

#include "calib/eye_file/eye_file.hpp"
#include "firmware/eye/measured_eye.hpp"
#include "hal/result.hpp"
#include "recon/problem/progress.hpp"

namespace compueye::firmware {

/// What an eye file has of a distance, or what follows for it from two others.
struct RowsAtDistance {
  std::int64_t id = 0;         ///< of the estimate; the nearer one's of two
  std::uint64_t raw_hash = 0;  ///< of the captures of all sessions
  calib::Estimate estimate;    ///< of two: the nearer one's but for status, dark levels, sessions, distance and date
  calib::MeasuredResponse measured;
  std::optional<MeasuredBetween> between;
};

/// By choose_estimate(). Errors: those of it and of EyeFile; interrupted; mismatch (two sessions of other
/// configurations, or whose exposure only one knows; parts of an estimate that do not fit each other).
[[nodiscard]] hal::Result<RowsAtDistance> rows_at(const calib::EyeFile& file, std::optional<double> distance_mm,
                                                  const recon::Progress& progress);

/// Of a frame of the captures that an estimate was made from. Nothing: there are none, or they did not choose it.
[[nodiscard]] hal::Result<std::optional<double>> exposure_s(const calib::EyeFile& file,
                                                            const calib::Estimate& estimate);

}  // namespace compueye::firmware
