#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calib/eye_file/eye_file.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// The captures of one stage of a session.
struct StageCounts {
  std::string stage;
  std::int64_t captures = 0, frames = 0;
  std::int64_t retakes = 0;    ///< taken again before they were good
  std::int64_t saturated = 0;  ///< of them, at least one channel
};

/// White as it came back between the patterns.
struct WhiteCapture {
  double minutes = 0.0;            ///< of the device, since the session's first capture
  std::vector<double> signal_lsb;  ///< M, mean of its frames over the mean dark one; NaN: not valid
};

struct PageSession {
  calib::StoredSession stored;
  std::vector<StageCounts> stages;  ///< in the order in which they began
  std::int64_t captures = 0;
  std::vector<WhiteCapture> whites;
};

/// The newest estimate and its rows.
struct PageEstimate {
  calib::StoredEstimate stored;
  calib::Estimate estimate;
  calib::MeasuredResponse rows;
  std::vector<double> row_error;  ///< M, relative, by the stated sigmas; NaN: not known
};

/// All that a page shows of an eye file.
struct PageData {
  std::string file;
  calib::EyeIdentity eye;
  std::vector<PageSession> sessions;
  std::vector<calib::StoredEstimate> estimates;
  std::optional<PageEstimate> newest;
};

/// Errors: those of calib::EyeFile.
[[nodiscard]] hal::Result<PageData> page_data(const std::string& path);

}  // namespace compueye::firmware
