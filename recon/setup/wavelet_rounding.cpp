#include "recon/setup/wavelet_rounding.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "recon/setup/quantised_response.hpp"

namespace compueye::recon {
namespace {

constexpr std::size_t tile = core::WaveletPicture::tile;
/// What taking a row apart in double leaves of a nought.
constexpr double rounding_of_double = 1e-9;
/// An average below this share of the largest is nought.
constexpr double least_average = 0x1p-20;

core::WaveletPicture shape_of(const Response& response) {
  return {static_cast<std::size_t>(response.image_rows()), static_cast<std::size_t>(response.image_cols())};
}

}  // namespace

bool wavelets_fit(const Response& response) noexcept {
  return std::min(response.image_rows(), response.image_cols()) >= least_wavelet_side &&
         shape_of(response).coefficients() <= tile << 16U;
}

WaveletRows::WaveletRows(const Response& response)
    : response_(response),
      shape_(shape_of(response)),
      picture_(static_cast<std::size_t>(response.cols()), 0.0),
      coefficients_(shape_.coefficients(), 0.0),
      scratch_(shape_.scratch_size(1), 0.0) {}

void WaveletRows::analyse(int m) {
  std::fill(picture_.begin(), picture_.end(), 0.0);
  response_.for_each_in_row(m, [&](std::int32_t n, double v) { picture_[static_cast<std::size_t>(n)] = v; });
  core::wavelet_analyse(shape_, picture_.data(), coefficients_.data(), scratch_.data());
  double largest = 0.0;
  for (const double c : coefficients_) largest = std::max(largest, std::abs(c));
  const double least = largest < least_row_peak ? largest : rounding_of_double * largest;
  tiles_.clear();
  for (std::size_t t = 0; t < coefficients_.size() / tile; ++t) {
    bool some = false;
    for (std::size_t k = t * tile; k < (t + 1) * tile; ++k) {
      if (std::abs(coefficients_[k]) <= least) coefficients_[k] = 0.0;
      some = some || coefficients_[k] != 0.0;
    }
    if (some) tiles_.push_back(t);
  }
}

double WaveletRows::largest_of(bool details) const {
  double largest = 0.0;
  for (const std::size_t t : tiles_) {
    if (is_detail(t) != details) continue;
    for (std::size_t k = t * tile; k < (t + 1) * tile; ++k) largest = std::max(largest, std::abs(coefficients_[k]));
  }
  return largest;
}

void WaveletRows::round_averages() {
  for (const std::size_t t : tiles_) {
    if (is_detail(t)) break;
    for (std::size_t k = t * tile; k < (t + 1) * tile; ++k) {
      coefficients_[k] = static_cast<double>(float_of_bf16(bf16_of(coefficients_[k])));
    }
  }
  // By rounded numbers, so that rounding once more finds the same: nothing is left near rounding_of_double.
  const double least = least_average * largest_of(false);
  for (std::size_t k = 0; k < shape_.averages(); ++k) {
    if (std::abs(coefficients_[k]) < least) coefficients_[k] = 0.0;
  }
}

void WaveletRows::round_details() {
  const float scale = int8_scale(largest_of(true));
  for (const std::size_t t : tiles_) {
    if (!is_detail(t)) continue;
    for (std::size_t k = t * tile; k < (t + 1) * tile; ++k) {
      coefficients_[k] = int8_of(coefficients_[k], scale) * static_cast<double>(scale);
    }
  }
}

/// Of averages at least half as bright as the brightest: what stays the same when others are left out.
double WaveletRows::energy_of_bright() const {
  const double half = 0.5 * largest_of(false);
  double energy = 0.0;
  for (std::size_t k = 0; k < shape_.averages(); ++k) {
    if (std::abs(coefficients_[k]) >= half) energy += coefficients_[k] * coefficients_[k];
  }
  return energy;
}

bool WaveletRows::drop_negligible(double least) {
  const auto negligible = [&](std::size_t t) {
    double energy = 0.0;
    for (std::size_t k = t * tile; k < (t + 1) * tile; ++k) energy += coefficients_[k] * coefficients_[k];
    if (energy > 0.0 && energy >= least) return false;
    for (std::size_t k = t * tile; k < (t + 1) * tile; ++k) coefficients_[k] = 0.0;
    return true;
  };
  return std::erase_if(tiles_, negligible) > 0;
}

void WaveletRows::round(int m) {
  analyse(m);
  round_averages();
  exact_ = coefficients_;
  const double least = negligible_tile * negligible_tile * energy_of_bright();
  // The scale is that of what stays, or the numbers could not be found again.
  do {
    for (const std::size_t t : tiles_) std::copy_n(&exact_[t * tile], tile, &coefficients_[t * tile]);
    round_details();
  } while (drop_negligible(least));
}

void WaveletRows::recover(int m) {
  analyse(m);
  round_averages();
  round_details();
}

const std::vector<double>& WaveletRows::picture() {
  core::wavelet_synthesise(shape_, coefficients_.data(), picture_.data(), scratch_.data());
  return picture_;
}

Response rounded_in_wavelets(const Response& response) {
  std::vector<std::int64_t> row_start{0};
  std::vector<std::int32_t> columns;
  std::vector<double> values;
  WaveletRows rows(response);
  for (int m = 0; m < response.rows(); ++m) {
    bool sees = false;
    response.for_each_in_row(m, [&](std::int32_t, double v) { sees = sees || v != 0.0; });
    if (sees) {
      rows.round(m);
      std::int32_t n = 0;
      for (const double v : rows.picture()) {
        if (v != 0.0) {
          columns.push_back(n);
          values.push_back(v);
        }
        ++n;
      }
    }
    row_start.push_back(static_cast<std::int64_t>(values.size()));
  }
  // The same shape with finite values: from_csr() has nothing to refuse.
  auto rounded =
      Response::from_csr(response.rows(), response.cols(), std::move(row_start), std::move(columns), std::move(values));
  return std::move(*rounded).with_image(response.image_rows(), response.image_cols()).value();
}

double worst_row_error(const Response& response, const Response& rounded) {
  std::vector<double> row(static_cast<std::size_t>(response.cols()), 0.0);
  double worst = 0.0;
  for (int m = 0; m < response.rows(); ++m) {
    double off = 0.0, whole = 0.0;
    response.for_each_in_row(m, [&](std::int32_t n, double v) {
      row[static_cast<std::size_t>(n)] = v;
      whole += v * v;
    });
    rounded.for_each_in_row(m, [&](std::int32_t n, double v) { row[static_cast<std::size_t>(n)] -= v; });
    const auto take = [&](std::int32_t n, double) {
      double& miss = row[static_cast<std::size_t>(n)];
      off += miss * miss;
      miss = 0.0;
    };
    response.for_each_in_row(m, take);
    rounded.for_each_in_row(m, take);
    if (whole > 0.0) worst = std::max(worst, std::sqrt(off / whole));
  }
  return worst;
}

}  // namespace compueye::recon
