#include "recon/setup/smoothing.hpp"

#include <cmath>
#include <numbers>

namespace compueye::recon {

std::vector<double> smoothing_eigenvalues(int image_rows, int image_cols) {
  std::vector<double> eigenvalues;
  for (int i = 0; i < image_rows; ++i) {
    const double down = 2.0 - 2.0 * std::cos(std::numbers::pi * i / image_rows);
    for (int k = 0; k < image_cols; ++k) {
      eigenvalues.push_back(1.0 + down + 2.0 - 2.0 * std::cos(std::numbers::pi * k / image_cols));
    }
  }
  return eigenvalues;
}

}  // namespace compueye::recon
