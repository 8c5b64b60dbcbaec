#include "calib/estimate/light_samples.hpp"
#include "calib/median.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace compueye::calib {
namespace {

constexpr double rounding_lsb2 = 1.0 / 12.0;

/// Linear between points, level beyond the first and last.
double interpolated(std::span<const double> times, std::span<const double> values, double time) noexcept {
  const auto after = std::upper_bound(times.begin(), times.end(), time);
  if (after == times.begin()) return values.front();
  if (after == times.end()) return values.back();
  const auto hi = static_cast<std::size_t>(after - times.begin()), lo = hi - 1;
  const double share = (time - times[lo]) / (times[hi] - times[lo]);
  return values[lo] + share * (values[hi] - values[lo]);
}

struct Mean {
  double sum = 0.0, count = 0.0;
  void add(double value) noexcept {
    if (std::isnan(value)) return;
    sum += value;
    count += 1.0;
  }
  [[nodiscard]] double value() const noexcept { return count > 0.0 ? sum / count : 0.0; }
};

class Maker {
 public:
  Maker(const Captures& captures, const CodeNoise& noise, int channels, int pixels, const StatusLimits& limits)
      : captures_(captures), noise_(noise), limits_(limits), width_(static_cast<std::size_t>(channels)) {
    made_.channels = channels;
    made_.patterns = captures.count(pixels);
    made_.status.assign(width_, ChannelStatus::good);
  }

  LightSamples make() && {
    find_saturated();
    straighten();
    measure_darks();
    measure_lamp();
    find_noisy();
    fill();
    return std::move(made_);
  }

 private:
  [[nodiscard]] bool good(std::size_t m) const noexcept { return made_.status[m] == ChannelStatus::good; }
  void mask(std::size_t m, ChannelStatus status) noexcept {
    if (good(m)) made_.status[m] = status;
  }

  void find_saturated() {
    if (!(noise_.saturated_lsb > 0.0)) return;
    const auto patterns = static_cast<double>(made_.patterns);
    for (std::size_t m = 0; m < width_; ++m) {
      double saturated = 0.0;
      for (std::size_t at = m; at < captures_.codes.size(); at += width_) {
        saturated += captures_.codes[at] >= noise_.saturated_lsb ? 1.0 : 0.0;
      }
      if (saturated > limits_.saturated_share * patterns) mask(m, ChannelStatus::saturated);
    }
  }

  [[nodiscard]] std::vector<double> straightened(const std::vector<double>& codes) const {
    std::vector<double> straight = codes;
    if (captures_.linearity.empty()) return straight;
    for (std::size_t at = 0; at < straight.size(); ++at) {
      straight[at] = captures_.linearity[at % width_].straightened(straight[at]);
    }
    return straight;
  }

  void straighten() {
    references_ = straightened(captures_.references.codes);
    darks_ = straightened(captures_.darks.codes);
    codes_ = straightened(captures_.codes);
    for (std::size_t at = 0; at < codes_.size() && noise_.saturated_lsb > 0.0; ++at) {
      if (captures_.codes[at] >= noise_.saturated_lsb) codes_[at] = std::numeric_limits<double>::quiet_NaN();
    }
  }

  void measure_darks() {
    made_.dark_lsb = captures_.dark_lsb.empty() ? std::vector<double>(width_, 0.0) : captures_.dark_lsb;
    const std::size_t count = captures_.darks.count();
    for (std::size_t m = 0; m < width_ && count > 0; ++m) {
      Mean mean;
      for (std::size_t d = 0; d < count; ++d) mean.add(darks_[d * width_ + m]);
      made_.dark_lsb[m] = mean.value();
    }
    const double middle = median(made_.dark_lsb);
    std::vector<double> deviations;
    for (const double dark : made_.dark_lsb) deviations.push_back(std::abs(dark - middle));
    const double deviation = std::max(median(deviations), limits_.least_deviation_lsb);
    for (std::size_t m = 0; m < width_; ++m) {
      if (made_.dark_lsb[m] - middle > limits_.hot_deviations * deviation) mask(m, ChannelStatus::hot);
    }
    for (std::size_t d = 0; d < count; ++d) {
      std::vector<double> moves;
      for (std::size_t m = 0; m < width_; ++m) {
        if (good(m)) moves.push_back(darks_[d * width_ + m] - made_.dark_lsb[m]);
      }
      dark_moves_.push_back(median(std::move(moves)));
    }
  }

  [[nodiscard]] double dark_at(std::size_t m, double time) const noexcept {
    return made_.dark_lsb[m] + (dark_moves_.empty() ? 0.0 : interpolated(captures_.darks.time, dark_moves_, time));
  }

  // Least squares of each reference on the channels' means, all channels of one noise: the brightest count most.
  void measure_lamp() {
    const Interleaved& references = captures_.references;
    white_lsb_.assign(width_, 0.0);
    for (std::size_t m = 0; m < width_ && references.count() > 0; ++m) {
      Mean mean;
      for (std::size_t r = 0; r < references.count(); ++r) {
        references_[r * width_ + m] -= dark_at(m, references.time[r]);
        mean.add(references_[r * width_ + m]);
      }
      white_lsb_[m] = mean.value();
    }
    find_blinking();
    for (std::size_t r = 0; r < references.count(); ++r) {
      double product = 0.0, square = 0.0;
      for (std::size_t m = 0; m < width_; ++m) {
        const double light = references_[r * width_ + m];
        if (!good(m) || std::isnan(light)) continue;
        product += light * white_lsb_[m];
        square += white_lsb_[m] * white_lsb_[m];
      }
      lamp_.push_back(square > 0.0 && product > 0.0 ? product / square : 1.0);
    }
  }

  /// A channel that goes far more than the lamp does would be taken for the lamp, and make all others noisy.
  void find_blinking() {
    const std::size_t count = captures_.references.count();
    if (count < 2) return;
    std::vector<double> spreads(width_), relative;
    for (std::size_t m = 0; m < width_; ++m) {
      double squares = 0.0;
      for (std::size_t r = 0; r < count; ++r) {
        const double off = references_[r * width_ + m] - white_lsb_[m];
        if (!std::isnan(off)) squares += off * off;
      }
      spreads[m] = squares / static_cast<double>(count - 1);
      if (good(m) && white_lsb_[m] > 0.0) relative.push_back(spreads[m] / (white_lsb_[m] * white_lsb_[m]));
    }
    const double lamp = median(std::move(relative));
    constexpr double most = 30.0;
    for (std::size_t m = 0; m < width_; ++m) {
      const double noise = variance_lsb2(white_lsb_[m]) / captures_.references.frames;
      if (spreads[m] > most * (noise + lamp * white_lsb_[m] * white_lsb_[m])) mask(m, ChannelStatus::noisy);
    }
  }

  [[nodiscard]] double variance_lsb2(double light_lsb) const noexcept {
    const double read = noise_.read_noise_lsb;
    const double shot = noise_.electrons_per_lsb ? std::max(light_lsb, 0.0) / *noise_.electrons_per_lsb : 0.0;
    return read * read + rounding_lsb2 + shot;
  }

  // By how references and darks scatter about what their neighbours in time say.
  void find_noisy() {
    for (std::size_t m = 0; m < width_; ++m) {
      double squares = 0.0, points = 0.0;
      for (std::size_t r = 0; r < lamp_.size(); ++r) {
        const double off = references_[r * width_ + m] - lamp_[r] * white_lsb_[m];
        if (std::isnan(off)) continue;
        squares += off * off * captures_.references.frames / variance_lsb2(lamp_[r] * white_lsb_[m]);
        points += 1.0;
      }
      for (std::size_t d = 0; d < dark_moves_.size(); ++d) {
        const double off = darks_[d * width_ + m] - made_.dark_lsb[m] - dark_moves_[d];
        if (std::isnan(off)) continue;
        squares += off * off * captures_.darks.frames / variance_lsb2(0.0);
        points += 1.0;
      }
      if (points >= 8.0 && squares > limits_.noisy_ratio * (points - 2.0)) mask(m, ChannelStatus::noisy);
    }
  }

  void fill() {
    const auto patterns = static_cast<std::size_t>(made_.patterns);
    const double unit = noise_.unit_lsb;
    made_.light.resize(codes_.size());
    for (std::size_t p = 0; p < patterns; ++p) {
      const double time = captures_.time.empty() ? 0.0 : captures_.time[p];
      const double lamp = lamp_.empty() ? 1.0 : interpolated(captures_.references.time, lamp_, time);
      const double frames = captures_.frames.empty() ? 1.0 : captures_.frames[p];
      const double scale = 1.0 / (lamp * unit);
      for (std::size_t m = 0; m < width_; ++m) {
        made_.light[p * width_ + m] = (codes_[p * width_ + m] - dark_at(m, time)) * scale;
      }
      made_.lamp.push_back(lamp);
      made_.fixed_variance.push_back(variance_lsb2(0.0) * scale * scale / frames);
      made_.light_variance.push_back(noise_.electrons_per_lsb ? scale / (*noise_.electrons_per_lsb * frames) : 0.0);
    }
    for (std::size_t m = 0; m < width_; ++m) {
      Mean mean;
      for (std::size_t p = 0; p < patterns; ++p) mean.add(made_.light[p * width_ + m]);
      made_.white.push_back(lamp_.empty() ? mean.value() : white_lsb_[m] / unit);
    }
  }

  const Captures& captures_;
  const CodeNoise& noise_;
  const StatusLimits& limits_;
  std::size_t width_;
  LightSamples made_;
  std::vector<double> codes_, references_, darks_;  // straightened; references less dark
  std::vector<double> dark_moves_, lamp_, white_lsb_;
};

}  // namespace

LightSamples light_samples(const Captures& captures, const CodeNoise& noise, int channels, int pixels,
                           const StatusLimits& limits) {
  return Maker(captures, noise, channels, pixels, limits).make();
}

}  // namespace compueye::calib
