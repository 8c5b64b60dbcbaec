#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "calib/emva1288.hpp"
#include "calib/estimate/estimate.hpp"
#include "calib/eye_file/eye_file.hpp"

namespace compueye::firmware {

/// What an estimate was made from and by.
struct EstimateOrigin {
  std::vector<std::int64_t> sessions;  ///< ascending
  std::string program, method, plan;
  double distance_mm = 0.0;
  std::int64_t made_unix_s = 0;
  std::vector<calib::NamedNumber> kappas = {};  ///< as Estimate has them
};

/// An estimate with linearity (a table a channel of the same codes, or none) and noise of its channels, as an eye file
/// keeps it: all rows with their sigmas, those of channels that are not good empty. Its id in the file. Errors: those
/// of EyeFile::store_estimate().
[[nodiscard]] hal::Result<std::int64_t> store(const calib::ResponseEstimate& estimate,
                                              const std::vector<calib::LinearityTable>& linearity,
                                              const calib::SensorNoise& sensor, const EstimateOrigin& origin,
                                              calib::EyeFile& file);

}  // namespace compueye::firmware
