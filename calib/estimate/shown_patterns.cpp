#include "calib/estimate/shown_patterns.hpp"

#include <cmath>

namespace compueye::calib {

ShownPatterns::ShownPatterns(const Captures& captures, int pixels, const DisplayResponse& display) {
  for (const bool judging : {false, true}) {
    for (std::size_t p = 0; p < captures.held_out.size(); ++p) {
      if ((captures.held_out[p] != 0) == judging) order_.push_back(p);
    }
    if (!judging) fitted_ = count();
  }
  const auto width = static_cast<std::size_t>(pixels);
  light_.resize(order_.size() * width);
  for (std::size_t k = 0; k < order_.size(); ++k) {
    const float* pattern = captures.patterns.data() + order_[k] * width;
    for (std::size_t n = 0; n < width; ++n) {
      double value = static_cast<double>(pattern[n]);
      if (display.gamma != 1.0) value = std::pow(value, display.gamma);
      light_[n * order_.size() + k] = static_cast<float>(display.black_level + (1.0 - display.black_level) * value);
    }
  }
}

void ShownPatterns::add(std::span<const std::int32_t> pixels, std::span<const double> entries,
                        Eigen::VectorXd& sum) const {
  for (std::size_t j = 0; j < pixels.size(); ++j) {
    if (entries[j] != 0.0) sum += entries[j] * pixel(pixels[j]).cast<double>();
  }
}

}  // namespace compueye::calib
