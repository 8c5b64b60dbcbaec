#include "firmware/calibration/row_error.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "calib/median.hpp"

namespace compueye::firmware {

std::optional<double> median_row_error(const calib::MeasuredResponse& measured) {
  if (measured.sigma.empty()) return std::nullopt;
  std::vector<double> errors;
  std::size_t entry = 0;
  for (int m = 0; m < measured.response.rows(); ++m) {
    double squares = 0.0, error = 0.0;
    measured.response.for_each_in_row(m, [&](std::int32_t, double value) {
      const double sigma = measured.sigma[entry++];
      squares += value * value;
      error += sigma * sigma;
    });
    if (squares > 0.0) errors.push_back(std::sqrt(error / squares));
  }
  return calib::median(std::move(errors));
}

}  // namespace compueye::firmware
