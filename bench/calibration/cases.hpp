#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calib/estimate/estimate.hpp"
#include "tests/calib/estimate/simulated_session.hpp"

namespace compueye::bench {

/// What is shown, to what noise, and how rows are estimated from it.
struct CalibrationCase {
  std::string name;
  std::string patterns;  ///< "blobs", "hadamard" or "raster"
  int count = 256;       ///< of the blobs
  test::SessionSettings session;
  calib::RowMethod method = calib::RowMethod::hybrid;
};

struct CalibrationFigures {
  std::string name;
  double median_error = 0.0, mean_error = 0.0;  ///< of rows, relative
  double within_one = 0.0, within_two = 0.0;    ///< share of entries, of their sigmas
  double held_out_chi2 = 0.0;                   ///< median
  double row_s = 0.0;                           ///< one thread
  int rows = 0, good = 0;
  std::optional<double> nmse, unweighed_nmse;
};

/// The eye whose rows are known, and those that are judged (of PixelResponses::ommatidia).
struct CalibratedEye {
  sim::EyeToSimulate board;
  test::PixelResponses responses;
  std::vector<int> judged;
};

/// `build_seed` draws how it was built.
[[nodiscard]] hal::Result<CalibratedEye> small_eye(std::uint64_t build_seed);
/// 24 blocks of 3 x 3 ommatidia, evenly over how much of the display they see. Takes minutes.
[[nodiscard]] hal::Result<CalibratedEye> large_eye(std::uint64_t build_seed);

[[nodiscard]] std::vector<CalibrationCase> small_cases();
[[nodiscard]] std::vector<CalibrationCase> large_cases();

[[nodiscard]] hal::Result<CalibrationFigures> measured(const CalibratedEye& eye, const CalibrationCase& each);

}  // namespace compueye::bench
