#include "firmware/pipeline/correction.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::fail;
using hal::Result;

constexpr const char* place = "correction";

Result<void> check_size(const char* what, std::size_t size, std::size_t channels) {
  if (size == 0 || size == channels) return {};
  return fail(ErrorCode::mismatch, place,
              std::string(what) + " has " + std::to_string(size) + " entries, expected one for each of the " +
                  std::to_string(channels) + " channels, or none");
}

Result<void> check_scalar(const char* what, double value, double above, double up_to) {
  if (std::isfinite(value) && value > above && value <= up_to) return {};
  return fail(ErrorCode::out_of_range, place,
              std::string(what) + " is " + std::to_string(value) + ", expected a number above " +
                  std::to_string(above) +
                  (std::isfinite(up_to) ? " and at most " + std::to_string(up_to) : std::string()));
}

template <class Good>
Result<void> check_each(const char* what, std::span<const float> values, const char* expected, Good good,
                        const char* whose = "channel") {
  const auto bad = std::find_if_not(values.begin(), values.end(), good);
  if (bad == values.end()) return {};
  return fail(ErrorCode::out_of_range, place,
              std::string(what) + " of " + whose + " " + std::to_string(bad - values.begin()) + " is " +
                  std::to_string(*bad) + ", expected " + expected);
}

Result<void> check_measured(const MeasuredSensor& m, std::size_t channels) {
  const auto finite = [](float v) { return std::isfinite(v); };
  for (const auto& checked :
       {check_size("the measured mask", m.masked.size(), channels),
        check_size("the measured dark level", m.dark.size(), channels),
        check_each("the measured dark level", m.dark, "a finite number", finite, "ommatidium"),
        check_each("the measured linearity", m.codes, "a finite code", finite, "point"),
        check_each("the straightened code", m.straightened, "a finite number", finite, "entry")}) {
    if (!checked) return checked;
  }
  if (m.straightened.size() != m.codes.size() * channels) {
    return fail(ErrorCode::mismatch, place,
                "the measured linearity has " + std::to_string(m.straightened.size()) +
                    " straightened codes, expected " + std::to_string(m.codes.size()) + " for each of the " +
                    std::to_string(channels) + " ommatidia");
  }
  const bool ascends = std::adjacent_find(m.codes.begin(), m.codes.end(), std::greater_equal<float>()) == m.codes.end();
  if (m.codes.size() != 1 && ascends) return {};
  return fail(ErrorCode::out_of_range, place, "the measured linearity does not have two or more codes that ascend");
}

Result<void> check_source(const hal::SourceDescription& source) {
  if (source.channels < 1 || source.bits < 1 || source.bits > 24) {
    return fail(ErrorCode::out_of_range, source.serial,
                "the source describes " + std::to_string(source.channels) + " channels of " +
                    std::to_string(source.bits) + " bits, expected at least 1 channel of 1 to 24 bits");
  }
  const auto channels = static_cast<std::size_t>(source.channels);
  if (source.ommatidium_of_channel.size() != channels) {
    return fail(ErrorCode::mismatch, source.serial,
                "the channel map has " + std::to_string(source.ommatidium_of_channel.size()) +
                    " entries, expected one for each of the " + std::to_string(channels) + " channels");
  }
  std::vector<bool> taken(channels, false);
  for (std::size_t c = 0; c < channels; ++c) {
    const std::int32_t m = source.ommatidium_of_channel[c];
    if (m < 0 || m >= source.channels) {
      return fail(ErrorCode::out_of_range, source.serial,
                  "channel " + std::to_string(c) + " is mapped to ommatidium " + std::to_string(m) +
                      ", expected 0 to " + std::to_string(channels - 1));
    }
    if (taken[static_cast<std::size_t>(m)]) {
      return fail(ErrorCode::mismatch, source.serial,
                  "channel " + std::to_string(c) + " is mapped to ommatidium " + std::to_string(m) +
                      ", which another channel already has");
    }
    taken[static_cast<std::size_t>(m)] = true;
  }
  return {};
}

Result<void> check_settings(const CorrectionSettings& s, std::size_t channels) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const auto& checked :
       {check_size("the dark frame", s.dark.size(), channels), check_size("the gain list", s.gain.size(), channels),
        check_size("the list of seeing ommatidia", s.sees.size(), channels),
        check_each("the dark level", s.dark, "a finite number", [](float v) { return std::isfinite(v); }),
        check_each("the gain", s.gain, "a number above 0", [](float v) { return std::isfinite(v) && v > 0.0F; }),
        check_scalar("lsb", s.lsb, 0.0, infinity),
        check_scalar("saturation_share", s.saturation_share, 0.0, infinity)}) {
    if (!checked) return checked;
  }
  TRY(check_measured(s.measured, channels));
  if (!(s.max_missing_share >= 0.0 && s.max_missing_share <= 1.0)) {
    return fail(ErrorCode::out_of_range, place,
                "max_missing_share is " + std::to_string(s.max_missing_share) + ", expected 0 to 1");
  }
  for (const std::int32_t c : s.dead_channels) {
    if (c >= 0 && static_cast<std::size_t>(c) < channels) continue;
    return fail(ErrorCode::out_of_range, place,
                "dead channel " + std::to_string(c) + " does not exist, expected 0 to " + std::to_string(channels - 1));
  }
  return {};
}

std::int32_t first_saturated_code(int bits, double share) {
  const double full_scale = static_cast<double>((std::int32_t{1} << bits) - 1);
  // Beyond full scale stands for "never"; the clamp keeps absurd shares inside the integer.
  return static_cast<std::int32_t>(std::ceil(std::min(share, 2.0) * full_scale));
}

}  // namespace

Result<Correction> Correction::create(const CorrectionSettings& settings, const hal::SourceDescription& source) {
  TRY(check_source(source));
  const auto channels = static_cast<std::size_t>(source.channels);
  TRY(check_settings(settings, channels));

  Correction c;
  c.bits_ = source.bits;
  c.saturation_code_ = first_saturated_code(source.bits, settings.saturation_share);
  c.expected_config_ = c.config_ = settings.expected_config_id;
  c.channels_.resize(channels);
  for (std::size_t i = 0; i < channels; ++i) {
    Channel& channel = c.channels_[i];
    channel.ommatidium = source.ommatidium_of_channel[i];
    channel.dark = settings.dark.empty() ? 0.0F : settings.dark[i];
    channel.scale = static_cast<float>((settings.gain.empty() ? 1.0 : settings.gain[i]) * settings.lsb);
    channel.sees = settings.sees.empty() || settings.sees[static_cast<std::size_t>(channel.ommatidium)] != 0;
  }
  c.take_measured(settings.measured);
  c.seeing_ = static_cast<int>(
      std::count_if(c.channels_.begin(), c.channels_.end(), [](const Channel& channel) { return channel.sees; }));
  int dead = 0;
  for (const std::int32_t d : settings.dead_channels) {
    Channel& channel = c.channels_[static_cast<std::size_t>(d)];
    if (channel.alive && channel.sees) ++dead;
    channel.alive = false;
  }
  if (c.seeing_ == 0) return fail(ErrorCode::usage, place, "no ommatidium sees the object plane, so there is no image");
  // The small term lets a share such as 0.05 of 60 channels admit its exact count of 3 despite rounding.
  c.max_masked_ = static_cast<int>(std::floor(settings.max_missing_share * c.seeing_ + 1e-9));
  if (dead > c.max_masked_) {
    return fail(ErrorCode::usage, place,
                std::to_string(dead) + " of " + std::to_string(c.seeing_) +
                    " seeing channels are listed as dead, and max_missing_share allows " +
                    std::to_string(c.max_masked_) + ", so every frame would be dropped");
  }
  return c;
}

void Correction::take_measured(const MeasuredSensor& measured) {
  const std::size_t points = measured.codes.size();
  if (points > 0) knots_.assign(measured.codes.begin(), measured.codes.end() - 1);
  for (Channel& channel : channels_) {
    const auto m = static_cast<std::size_t>(channel.ommatidium);
    if (!measured.masked.empty() && measured.masked[m] != 0) channel.alive = channel.sees = false;
    if (!measured.dark.empty()) channel.dark = measured.dark[m];
    for (std::size_t k = 0; k + 1 < points; ++k) {
      const float* const value = &measured.straightened[m * points + k];
      pieces_.push_back({value[0], (value[1] - value[0]) / (measured.codes[k + 1] - measured.codes[k])});
    }
  }
}

float Correction::straightened(std::size_t channel, float code) const noexcept {
  const auto after = std::upper_bound(knots_.begin() + 1, knots_.end(), code);
  const auto k = static_cast<std::size_t>(after - knots_.begin()) - 1;
  const Piece& piece = pieces_[channel * knots_.size() + k];
  return piece.first + (code - knots_[k]) * piece.slope;
}

bool Correction::matches_configuration(const hal::SampleBlock& block) noexcept {
  if (!config_) config_ = block.config_id;
  return *config_ == block.config_id;
}

CorrectionReport Correction::apply(const hal::SampleBlock& block, std::span<float> y,
                                   std::span<float> weights) noexcept {
  CorrectionReport report;
  if (block.codes.size() != channels_.size() || block.valid.size() != channels_.size() || block.bits != bits_) {
    return report;
  }
  if (!matches_configuration(block)) {
    report.config_mismatch = true;
    return report;
  }
  const std::int32_t full_scale = (std::int32_t{1} << bits_) - 1;
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    const Channel& channel = channels_[c];
    const std::int32_t code = block.codes[c];
    const bool measured = channel.alive && block.valid[c] != 0 && code >= 0 && code <= full_scale;
    const bool saturated = measured && code >= saturation_code_;
    const bool used = measured && !saturated;
    const auto m = static_cast<std::size_t>(channel.ommatidium);
    const float level = knots_.empty() ? static_cast<float>(code) : straightened(c, static_cast<float>(code));
    y[m] = used ? (level - channel.dark) * channel.scale : 0.0F;
    weights[m] = used ? 1.0F : 0.0F;
    report.masked += static_cast<int>(channel.sees && !used);
    report.saturated += static_cast<int>(channel.sees && saturated);
  }
  report.usable = report.masked <= max_masked_;
  report.reason = hal::DropReason::too_few_channels;
  return report;
}

}  // namespace compueye::firmware
