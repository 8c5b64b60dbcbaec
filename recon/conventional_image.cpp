#include "recon/conventional_image.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace compueye::recon {
namespace {

struct Centroid {
  double row;
  double col;
  std::int32_t m;
};

// Positions in pixel units, pixel (r, c) being centred on (r, c).
std::vector<Centroid> centroids(const Response& response, std::span<const double> sums, int image_cols) {
  std::vector<Centroid> found;
  for (int m = 0; m < response.rows(); ++m) {
    if (!(sums[static_cast<std::size_t>(m)] > 0.0)) continue;
    double weight = 0.0, row = 0.0, col = 0.0;
    response.for_each_in_row(m, [&](std::int32_t pixel, double value) {
      const double w = std::abs(value);
      weight += w;
      const std::int32_t pixel_row = pixel / image_cols, pixel_col = pixel % image_cols;
      row += w * pixel_row;
      col += w * pixel_col;
    });
    found.push_back({row / weight, col / weight, m});
  }
  return found;
}

class NearestCentroid {
 public:
  explicit NearestCentroid(std::vector<Centroid> all) : all_(std::move(all)) {
    std::sort(all_.begin(), all_.end(),
              [](const Centroid& a, const Centroid& b) { return a.row < b.row || (a.row == b.row && a.m < b.m); });
  }

  // Sorted by row: looks up and down from the pixel's own row until the row alone is farther than the best.
  [[nodiscard]] std::int32_t find(double row, double col) const {
    const auto start =
        std::lower_bound(all_.begin(), all_.end(), row, [](const Centroid& c, double r) { return c.row < r; });
    Best best;
    for (auto c = start; c != all_.end() && square(c->row - row) <= best.distance; ++c) best.offer(*c, row, col);
    for (auto c = start; c != all_.begin() && square((c - 1)->row - row) <= best.distance; --c) {
      best.offer(*(c - 1), row, col);
    }
    return best.m;
  }

 private:
  static double square(double v) { return v * v; }

  struct Best {
    double distance = HUGE_VAL;
    std::int32_t m = 0;
    void offer(const Centroid& c, double row, double col) {
      const double d = square(c.row - row) + square(c.col - col);
      if (d < distance || (d == distance && c.m < m)) {
        distance = d;
        m = c.m;
      }
    }
  };

  std::vector<Centroid> all_;
};

}  // namespace

hal::Result<ConventionalImage> ConventionalImage::create(const Response& response) {
  if (response.image_rows() == 0) {
    return hal::fail(hal::ErrorCode::mismatch, "conventional eye",
                     "has a response of " + std::to_string(response.cols()) +
                         " columns, expected one that knows the rows and columns of its picture");
  }
  ConventionalImage image;
  image.channels_ = response.rows();
  image.image_rows_ = response.image_rows();
  image.image_cols_ = response.image_cols();
  const std::vector<double> sums = response.row_sums();
  std::vector<Centroid> seeing = centroids(response, sums, response.image_cols());
  if (seeing.empty()) {
    return hal::fail(hal::ErrorCode::out_of_range, "conventional eye",
                     "has no ommatidium that sees the object, expected a response with a positive row");
  }
  image.scale_.assign(sums.size(), 0.0F);
  for (const Centroid& c : seeing) {
    const auto m = static_cast<std::size_t>(c.m);
    image.scale_[m] = static_cast<float>(1.0 / sums[m]);
  }
  const NearestCentroid nearest(std::move(seeing));
  image.source_.reserve(static_cast<std::size_t>(response.cols()));
  for (int r = 0; r < response.image_rows(); ++r) {
    for (int c = 0; c < response.image_cols(); ++c) image.source_.push_back(nearest.find(r, c));
  }
  return image;
}

void ConventionalImage::render(std::span<const float> y, std::span<float> picture) const noexcept {
  for (std::size_t n = 0; n < source_.size(); ++n) {
    const auto m = static_cast<std::size_t>(source_[n]);
    const float value = y[m] * scale_[m];
    // Written so that NaN ends in 0.
    picture[n] = value > 0.0F ? std::min(value, 1.0F) : 0.0F;
  }
}

}  // namespace compueye::recon
