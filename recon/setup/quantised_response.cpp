#include "recon/setup/quantised_response.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "recon/setup/operator_list.hpp"
#include "recon/setup/wavelet_rounding.hpp"

namespace compueye::recon {

float int8_scale(double largest) noexcept {
  return largest < least_row_peak ? 0.0F : static_cast<float>(largest / 127.0);
}

std::int8_t int8_of(double value, float scale) noexcept {
  if (scale == 0.0F) return 0;
  return static_cast<std::int8_t>(std::clamp(std::nearbyint(value / static_cast<double>(scale)), -127.0, 127.0));
}

std::uint16_t bf16_of(double value) noexcept {
  constexpr double most = 0x1.FEp127;
  const auto rounded = static_cast<float>(std::clamp(value, -most, most));
  if (std::abs(rounded) < std::numeric_limits<float>::min()) return 0;
  const auto bits = std::bit_cast<std::uint32_t>(rounded);
  const std::uint32_t even = (bits >> 16U) & 1U;
  return static_cast<std::uint16_t>((bits + 0x7FFFU + even) >> 16U);
}

float float_of_bf16(std::uint16_t bits) noexcept {
  return std::bit_cast<float>(static_cast<std::uint32_t>(bits) << 16U);
}

Response quantised(const Response& response, OperatorKind kind) {
  if (!is_lossy(kind) || response.rounded_for() == kind) return response;
  if (kind == OperatorKind::wavelet_runs && !wavelets_fit(response)) return response;
  if (kind == OperatorKind::wavelet_runs) return rounded_in_wavelets(response).said_to_be_rounded_for(kind);
  std::vector<std::int64_t> row_start{0};
  std::vector<std::int32_t> columns;
  std::vector<double> values;
  for (int m = 0; m < response.rows(); ++m) {
    double largest = 0.0;
    response.for_each_in_row(m, [&](std::int32_t, double v) { largest = std::max(largest, std::abs(v)); });
    const float scale = int8_scale(largest);
    response.for_each_in_row(m, [&](std::int32_t n, double v) {
      const double stored = kind == OperatorKind::dense_runs_int8 ? int8_of(v, scale) * static_cast<double>(scale)
                                                                  : static_cast<double>(float_of_bf16(bf16_of(v)));
      if (stored == 0.0) return;
      columns.push_back(n);
      values.push_back(stored);
    });
    row_start.push_back(static_cast<std::int64_t>(values.size()));
  }
  // The same shape with finite values: from_csr() has nothing to refuse.
  auto rounded =
      Response::from_csr(response.rows(), response.cols(), std::move(row_start), std::move(columns), std::move(values));
  return std::move(*rounded)
      .with_image(response.image_rows(), response.image_cols())
      .value()
      .said_to_be_rounded_for(kind);
}

bool keeps_details(const Response& response, const Response& rounded) {
  std::vector<double> row(static_cast<std::size_t>(response.cols()), 0.0);
  double off = 0.0, details = 0.0;
  for (int m = 0; m < response.rows(); ++m) {
    double sum = 0.0;
    response.for_each_in_row(m, [&](std::int32_t n, double v) {
      row[static_cast<std::size_t>(n)] = v;
      sum += v;
    });
    const double mean = sum / response.cols();
    rounded.for_each_in_row(m, [&](std::int32_t n, double v) {
      const double miss = row[static_cast<std::size_t>(n)] - v;
      off += miss * miss;
    });
    response.for_each_in_row(m, [&](std::int32_t n, double v) {
      details += v * (v - mean);
      row[static_cast<std::size_t>(n)] = 0.0;
    });
  }
  return off <= most_rounding * most_rounding * details;
}

}  // namespace compueye::recon
