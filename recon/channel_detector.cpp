#include "recon/channel_detector.hpp"

#include <algorithm>
#include <cmath>

namespace compueye::recon {
namespace {

float median_of(std::span<float> values) noexcept {
  if (values.empty()) return 0.0F;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

ChannelDetector::ChannelDetector(int lattice_rows, int lattice_columns, std::span<const std::uint8_t> sees,
                                 const ChannelDetectorSettings& settings)
    : rows_(lattice_rows),
      columns_(lattice_columns),
      settings_(settings),
      sees_(sees.begin(), sees.end()),
      masked_(sees.size(), 0),
      off_(sees.size(), 0),
      apart_(sees.size(), 0.0F),
      scratch_(sees.size() + (2 * reach + 1) * (2 * reach + 1)),
      off_looks_(sees.size(), 0),
      healthy_looks_(sees.size(), 0),
      wanted_looks_(sees.size(), settings.healthy_looks) {}

template <class Visit>
void ChannelDetector::for_each_neighbour(std::size_t m, Visit&& visit) const {
  const int row = static_cast<int>(m) / columns_, column = static_cast<int>(m) % columns_;
  for (int i = std::max(0, row - reach); i <= std::min(rows_ - 1, row + reach); ++i) {
    for (int k = std::max(0, column - reach); k <= std::min(columns_ - 1, column + reach); ++k) {
      const auto n = static_cast<std::size_t>(i * columns_ + k);
      if (n != m && masked_[n] == 0) visit(n);
    }
  }
}

float ChannelDetector::median_around(std::size_t m, std::span<const float> of,
                                     std::span<const float> weights) noexcept {
  std::size_t n = 0;
  for_each_neighbour(m, [&](std::size_t other) {
    if (in_use(other, weights)) scratch_[n++] = of[other];
  });
  return median_of(std::span(scratch_).first(n));
}

double ChannelDetector::measure(std::span<const float> residuals, std::span<const float> weights) noexcept {
  for (std::size_t m = 0; m < sees_.size(); ++m) {
    if (in_use(m, weights)) apart_[m] = residuals[m] - median_around(m, residuals, weights);
  }
  std::size_t n = 0;
  for (std::size_t m = 0; m < sees_.size(); ++m) {
    if (in_use(m, weights) && masked_[m] == 0) scratch_[n++] = std::abs(apart_[m]);
  }
  constexpr double deviations = 1.4826;  // of a normal distribution, from its median magnitude
  return std::max(settings_.sigma, deviations * static_cast<double>(median_of(std::span(scratch_).first(n))));
}

bool ChannelDetector::leads(std::size_t m, std::span<const float> weights) const noexcept {
  bool most = true;
  for_each_neighbour(m, [&](std::size_t other) {
    if (in_use(other, weights) && std::abs(apart_[other]) > std::abs(apart_[m])) most = false;
  });
  return most;
}

bool ChannelDetector::look(std::span<const float> y, std::span<const float> residuals,
                           std::span<const float> weights) noexcept {
  const double scale = measure(residuals, weights);
  if (!(scale > 0.0)) return false;
  std::size_t off = 0;
  for (std::size_t m = 0; m < sees_.size(); ++m) {
    off_[m] = 0;
    if (!in_use(m, weights) || masked_[m] != 0) continue;
    const auto apart = static_cast<double>(std::abs(apart_[m]));
    if (!(apart > settings_.outlier * scale)) continue;
    ++off;
    const auto around = static_cast<double>(std::abs(median_around(m, y, weights)));
    if (apart > settings_.share * around && leads(m, weights)) off_[m] = 1;
  }
  if (off + count_ > settings_.most) {
    ++crowded_;
    std::fill(off_.begin(), off_.end(), std::uint8_t{0});
  }
  unmask_healthy(scale, weights);
  return mask_suspects();
}

bool ChannelDetector::mask_suspects() noexcept {
  bool any = false;
  for (std::size_t m = 0; m < off_.size(); ++m) {
    off_looks_[m] = off_[m] != 0 ? off_looks_[m] + 1 : 0;
    if (off_looks_[m] < settings_.looks || count_ >= settings_.most) continue;
    masked_[m] = 1;
    ++count_;
    ++found_;
    off_looks_[m] = healthy_looks_[m] = 0;
    any = true;
  }
  return any;
}

void ChannelDetector::unmask_healthy(double scale, std::span<const float> weights) noexcept {
  for (std::size_t m = 0; m < masked_.size(); ++m) {
    if (masked_[m] == 0 || !in_use(m, weights)) continue;
    const bool right = static_cast<double>(std::abs(apart_[m])) < 0.5 * settings_.outlier * scale;
    healthy_looks_[m] = right ? healthy_looks_[m] + 1 : 0;
    if (healthy_looks_[m] < wanted_looks_[m]) continue;
    masked_[m] = 0;
    --count_;
    ++recovered_;
    wanted_looks_[m] = std::min(2 * wanted_looks_[m], settings_.most_looks);
  }
}

}  // namespace compueye::recon
