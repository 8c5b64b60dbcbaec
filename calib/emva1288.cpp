#include "calib/emva1288.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "calib/median.hpp"
#include "hal/try.hpp"

namespace compueye::calib {
namespace {

using hal::ErrorCode;
using hal::fail;
using hal::Result;

constexpr double rounding_variance = 1.0 / 12.0;
constexpr double least_dark_variance = 0.24;  // release 4, section 6.6: below it rounding dominates
constexpr double share_for_gain = 0.7, full_share = 0.98;

/// Mean and temporal variance of each channel under one light.
struct Statistics {
  double light = 0.0, exposure_s = 0.0;
  std::size_t frames = 0;
  std::vector<double> mean, variance;
};

Statistics means_of(const LightSeries& series, std::size_t channels) {
  Statistics s{series.light, series.exposure_s, series.codes.size() / channels, std::vector<double>(channels),
               std::vector<double>(channels)};
  for (std::size_t n = 0; n < series.codes.size(); ++n) s.mean[n % channels] += series.codes[n];
  for (double& mean : s.mean) mean /= static_cast<double>(s.frames);
  return s;
}

/// Channels that vary no more than others under the same light: one that blinks would pass for a lamp that does.
std::vector<double> steady_ones(const LightSeries& series, const std::vector<double>& picture, const Statistics& s) {
  std::vector<double> spread(picture.size());
  for (std::size_t n = 0; n < series.codes.size(); ++n) {
    const std::size_t m = n % picture.size();
    spread[m] += std::pow(series.codes[n] - s.mean[m], 2);
  }
  constexpr double most = 30.0;
  const double limit = most * median(spread);
  std::vector<double> steady = picture;
  for (std::size_t m = 0; m < picture.size(); ++m) steady[m] = spread[m] <= limit ? picture[m] : 0.0;
  return steady;
}

/// Temporal variances, what each frame has in common with `picture` (a number a channel; all 0: nothing) taken off.
void add_variances(const LightSeries& series, const std::vector<double>& picture, Statistics& s) {
  const std::size_t channels = picture.size();
  const std::vector<double> steady = steady_ones(series, picture, s);
  double power = 0.0;
  for (const double each : steady) power += each * each;
  for (std::size_t f = 0; f < s.frames; ++f) {
    double common = 0.0;
    const std::int32_t* codes = series.codes.data() + f * channels;
    for (std::size_t m = 0; m < channels; ++m) common += steady[m] * (codes[m] - s.mean[m]);
    common = power > 0.0 ? common / power : 0.0;
    for (std::size_t m = 0; m < channels; ++m) {
      s.variance[m] += std::pow(codes[m] - s.mean[m] - common * picture[m], 2);
    }
  }
  for (std::size_t m = 0; m < channels; ++m) {
    const double left = power > 0.0 ? 1.0 - steady[m] * picture[m] / power : 1.0;
    s.variance[m] = left > 0.0 ? s.variance[m] / static_cast<double>(s.frames - 1) / left : 0.0;
  }
}

/// All that is known of one channel, flats in order of light.
struct Transfer {
  std::vector<double> light, signal, variance;  ///< less the dark ones
  std::vector<double> variance_error;           ///< standard errors
  double full_lsb = 0.0;                        ///< largest code that counts, less the dark mean
  double dark_variance = 0.0;                   ///< at the shortest exposure
};

/// Where the variance is largest, if it falls to less than half beyond.
std::optional<double> saturation_lsb(const Transfer& t) {
  if (t.signal.empty()) return {};
  const auto peak = std::max_element(t.variance.begin(), t.variance.end());
  const double after = *std::min_element(peak, t.variance.end());
  if (!(*peak > 0.0 && after < *peak / 2.0)) return {};
  return t.signal[static_cast<std::size_t>(peak - t.variance.begin())];
}

/// Of the variance over the signal, with its standard error.
struct Slope {
  double value = 0.0, error = 0.0;
};

std::optional<Slope> gain_slope(const Transfer& t, double saturation) {
  double xy = 0.0, xx = 0.0, error = 0.0;
  for (std::size_t k = 0; k < t.signal.size(); ++k) {
    const double x = t.signal[k];
    if (!(x > 0.0 && x <= share_for_gain * saturation)) continue;
    xy += x * t.variance[k];
    xx += x * x;
    error += std::pow(x * t.variance_error[k], 2);
  }
  if (!(xx > 0.0)) return {};
  return Slope{xy / xx, std::sqrt(error) / xx};
}

constexpr double errors_above_nought = 3.0;

/// The median channel's, where no single one can be told: of M channels it is known about sqrt(M) times better.
std::optional<double> gain_of_all(const std::vector<Slope>& slopes) {
  std::vector<double> values, errors;
  for (const Slope& each : slopes) {
    values.push_back(each.value);
    errors.push_back(each.error);
  }
  if (values.size() < 2) return {};
  const double error = 1.2533 * median(std::move(errors)) / std::sqrt(static_cast<double>(values.size()));
  const double value = median(std::move(values));
  return value > errors_above_nought * error ? std::optional(value) : std::nullopt;
}

/// Section 9: a line of least relative distances, and the mean of their absolute values.
std::optional<double> linearity_error(const Transfer& t, double saturation) {
  double w0 = 0.0, w1 = 0.0, w2 = 0.0, r0 = 0.0, r1 = 0.0;
  const auto counts = [&](double y) { return y >= 0.05 * saturation && y <= 0.95 * saturation; };
  int points = 0;
  for (std::size_t k = 0; k < t.signal.size(); ++k) {
    const double y = t.signal[k], x = t.light[k];
    if (!counts(y)) continue;
    const double weight = 1.0 / (y * y);
    w0 += weight;
    w1 += weight * x;
    w2 += weight * x * x;
    r0 += weight * y;
    r1 += weight * x * y;
    ++points;
  }
  const double determinant = w0 * w2 - w1 * w1;
  if (points < 3 || !(determinant > 1e-12 * w0 * w2)) return {};
  const double offset = (r0 * w2 - r1 * w1) / determinant, slope = (r1 * w0 - r0 * w1) / determinant;
  double sum = 0.0;
  for (std::size_t k = 0; k < t.signal.size(); ++k) {
    const double line = offset + slope * t.light[k];
    if (counts(t.signal[k])) sum += std::fabs(t.signal[k] / line - 1.0);
  }
  return sum / points;
}

/// Slope of the dark mean over the exposure, LSB/s.
std::optional<double> dark_slope(const std::vector<Statistics>& darks, std::size_t m) {
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  for (const Statistics& dark : darks) {
    n += 1.0;
    x += dark.exposure_s;
    y += dark.mean[m];
    xx += dark.exposure_s * dark.exposure_s;
    xy += dark.exposure_s * dark.mean[m];
  }
  const double determinant = n * xx - x * x;
  if (!(determinant > 1e-12 * n * xx)) return {};
  return (n * xy - x * y) / determinant;
}

ChannelNoise channel_noise(const Transfer& t, std::optional<double> dark_lsb_per_s, std::vector<Slope>& slopes) {
  ChannelNoise noise;
  noise.dark_noise_lsb = std::sqrt(t.dark_variance);
  const std::optional<double> saturation = saturation_lsb(t);
  const double reach = saturation.value_or(t.full_lsb);
  noise.linearity_error = linearity_error(t, reach);
  const std::optional<Slope> slope = gain_slope(t, reach);
  if (slope) slopes.push_back(*slope);
  if (!slope || !(slope->value > errors_above_nought * slope->error)) return noise;
  const double k = slope->value;
  noise.gain_lsb_per_e = k;
  const double dark_e2 = (std::max(t.dark_variance, least_dark_variance) - rounding_variance) / (k * k);
  noise.read_noise_e = std::sqrt(dark_e2);
  if (dark_lsb_per_s) noise.dark_current_e_per_s = *dark_lsb_per_s / k;
  if (!saturation) return noise;
  noise.saturation_e = *saturation / k;
  const double threshold_e = std::sqrt(dark_e2 + rounding_variance / (k * k) + 0.25) + 0.5;
  noise.dynamic_range = *noise.saturation_e / threshold_e;
  return noise;
}

std::optional<double> median_of(const std::vector<ChannelNoise>& channels, std::optional<double> ChannelNoise::*what) {
  std::vector<double> told;
  for (const ChannelNoise& each : channels) {
    if (each.*what) told.push_back(*(each.*what));
  }
  if (2 * told.size() <= channels.size()) return {};
  const auto middle = told.begin() + static_cast<std::ptrdiff_t>(told.size() / 2);
  std::nth_element(told.begin(), middle, told.end());
  return *middle;
}

/// Variance of the means over the channels that have a gain, temporal noise taken off.
double spatial_variance(const Statistics& s, const std::vector<ChannelNoise>& channels) {
  double n = 0.0, sum = 0.0, squares = 0.0, temporal = 0.0;
  for (std::size_t m = 0; m < channels.size(); ++m) {
    if (!channels[m].gain_lsb_per_e) continue;
    n += 1.0;
    sum += s.mean[m];
    temporal += s.variance[m] / static_cast<double>(s.frames);
  }
  for (std::size_t m = 0; m < channels.size(); ++m) {
    if (channels[m].gain_lsb_per_e) squares += std::pow(s.mean[m] - sum / n, 2);
  }
  return n > 1.0 ? squares / (n - 1.0) - temporal / n : 0.0;
}

double mean_over(const Statistics& s, const std::vector<ChannelNoise>& channels) {
  double n = 0.0, sum = 0.0;
  for (std::size_t m = 0; m < channels.size(); ++m) {
    if (!channels[m].gain_lsb_per_e) continue;
    n += 1.0;
    sum += s.mean[m];
  }
  return n > 0.0 ? sum / n : 0.0;
}

void add_spread(const Statistics& dark, const std::vector<Statistics>& flats, double full_lsb, SensorNoise& noise) {
  const std::optional<double> k = median_of(noise.channels, &ChannelNoise::gain_lsb_per_e);
  if (!k) return;
  const double dark_spread = std::max(spatial_variance(dark, noise.channels), 0.0);
  noise.dsnu_e = std::sqrt(dark_spread) / *k;
  const double dark_mean = mean_over(dark, noise.channels);
  const double saturation = noise.median.saturation_e ? *noise.median.saturation_e * *k : full_lsb - dark_mean;
  const auto away = [&](const Statistics& s) {
    return std::fabs(mean_over(s, noise.channels) - dark_mean - saturation / 2.0);
  };
  const Statistics& half =
      *std::min_element(flats.begin(), flats.end(), [&](const auto& a, const auto& b) { return away(a) < away(b); });
  const double signal = mean_over(half, noise.channels) - dark_mean;
  if (!(signal > 0.05 * saturation && signal < 0.95 * saturation)) return;
  noise.prnu = std::sqrt(std::max(spatial_variance(half, noise.channels) - dark_spread, 0.0)) / signal;
}

Result<void> check(std::span<const LightSeries> series, int channels, int bits) {
  const auto refused = [](ErrorCode code, const std::string& sentence) {
    return fail(code, "noise of sensor", sentence);
  };
  if (series.empty()) return refused(ErrorCode::usage, "there are no frames");
  if (channels < 1)
    return refused(ErrorCode::out_of_range, "channels are " + std::to_string(channels) + ", expected 1 or more");
  if (bits < 1 || bits > 24)
    return refused(ErrorCode::out_of_range, "bits are " + std::to_string(bits) + ", expected 1 to 24");
  for (std::size_t k = 0; k < series.size(); ++k) {
    const LightSeries& s = series[k];
    const std::string name = "series " + std::to_string(k);
    if (!(std::isfinite(s.light) && s.light >= 0.0 && std::isfinite(s.exposure_s) && s.exposure_s > 0.0)) {
      return refused(ErrorCode::out_of_range, name + " has light " + std::to_string(s.light) + " and exposure " +
                                                  std::to_string(s.exposure_s) + " s, expected 0 or more, more than 0");
    }
    const auto m = static_cast<std::size_t>(channels);
    if (s.codes.size() % m != 0 || s.codes.size() / m < 2) {
      return refused(ErrorCode::mismatch, name + " has " + std::to_string(s.codes.size()) +
                                              " codes, expected two or more frames of " + std::to_string(channels));
    }
  }
  return {};
}

/// Flats and darks apart, flats in order of light.
struct Sorted {
  std::vector<const LightSeries*> flats, darks;
  const LightSeries* dark = nullptr;  ///< of the flats' exposure
};

Result<Sorted> sorted(std::span<const LightSeries> series) {
  Sorted s;
  for (const LightSeries& each : series) (each.light > 0.0 ? s.flats : s.darks).push_back(&each);
  std::sort(s.flats.begin(), s.flats.end(), [](const auto* a, const auto* b) { return a->light < b->light; });
  std::sort(s.darks.begin(), s.darks.end(), [](const auto* a, const auto* b) { return a->exposure_s < b->exposure_s; });
  if (s.flats.empty()) return fail(ErrorCode::mismatch, "noise of sensor", "there is no series with light");
  const double exposure = s.flats.front()->exposure_s;
  for (const LightSeries* flat : s.flats) {
    if (flat->exposure_s == exposure) continue;
    return fail(ErrorCode::mismatch, "noise of sensor",
                "lit series have exposures of " + std::to_string(exposure) + " and " +
                    std::to_string(flat->exposure_s) + " s, expected one");
  }
  for (const LightSeries* dark : s.darks) s.dark = dark->exposure_s == exposure ? dark : s.dark;
  if (s.dark != nullptr) return s;
  return fail(ErrorCode::mismatch, "noise of sensor",
              "there is no dark series of the lit ones' exposure of " + std::to_string(exposure) + " s");
}

}  // namespace

Result<SensorNoise> sensor_noise(std::span<const LightSeries> series, int channels, int bits) {
  TRY(check(series, channels, bits));
  const Sorted order = TRY(sorted(series));
  const auto count = static_cast<std::size_t>(channels);
  const double full = full_share * (std::ldexp(1.0, bits) - 1.0);
  const auto dark_statistics = [&](const LightSeries& dark) {
    Statistics s = means_of(dark, count);
    add_variances(dark, std::vector<double>(count, 0.0), s);
    return s;
  };
  const Statistics dark = dark_statistics(*order.dark);
  std::vector<Statistics> darks, flats;
  for (const LightSeries* each : order.darks) darks.push_back(dark_statistics(*each));
  for (const LightSeries* each : order.flats) {
    Statistics& flat = flats.emplace_back(means_of(*each, count));
    std::vector<double> picture = flat.mean;
    for (std::size_t m = 0; m < count; ++m) picture[m] -= dark.mean[m];
    add_variances(*each, picture, flat);
  }
  SensorNoise noise;
  std::vector<Slope> slopes;
  for (std::size_t m = 0; m < count; ++m) {
    Transfer t;
    t.full_lsb = full - dark.mean[m];
    t.dark_variance = darks.front().variance[m];
    for (const Statistics& flat : flats) {
      t.light.push_back(flat.light);
      t.signal.push_back(flat.mean[m] - dark.mean[m]);
      t.variance.push_back(flat.variance[m] - dark.variance[m]);
      t.variance_error.push_back(std::hypot(flat.variance[m], dark.variance[m]) *
                                 std::sqrt(2.0 / static_cast<double>(flat.frames - 1)));
    }
    noise.channels.push_back(channel_noise(t, dark_slope(darks, m), slopes));
  }
  for (const auto what : {&ChannelNoise::gain_lsb_per_e, &ChannelNoise::dark_noise_lsb, &ChannelNoise::read_noise_e,
                          &ChannelNoise::dark_current_e_per_s, &ChannelNoise::saturation_e,
                          &ChannelNoise::linearity_error, &ChannelNoise::dynamic_range}) {
    noise.median.*what = median_of(noise.channels, what);
  }
  if (!noise.median.gain_lsb_per_e) noise.median.gain_lsb_per_e = gain_of_all(slopes);
  add_spread(dark, flats, full, noise);
  return noise;
}

}  // namespace compueye::calib
