#include "firmware/app/reconstruct/frame_inputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "firmware/files/npy.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::fail;
using hal::Result;
namespace fs = std::filesystem;

/// "frame 3, channel 17", or the channel alone where the file has no frames.
std::string where(const SampleArray& array, std::int64_t frame, std::int64_t channel) {
  if (!array.has_frame_axis) return fmt::format("channel {}", channel);
  return fmt::format("frame {}, channel {}", frame, channel);
}

Result<void> check_channels(const fs::path& file, const SampleArray& array, int channels) {
  if (array.channels == channels) return {};
  return fail(ErrorCode::mismatch, file.string(),
              fmt::format("has {} channels, expected {} as the response has rows", array.channels, channels));
}

Result<void> check_weights(const fs::path& file, const SampleArray& weights) {
  for (std::int64_t f = 0; f < weights.frames; ++f) {
    const auto frame = weights.frame(f);
    for (std::size_t m = 0; m < frame.size(); ++m) {
      if (std::isfinite(frame[m]) && frame[m] >= 0.0) continue;
      return fail(ErrorCode::out_of_range, file.string(),
                  fmt::format("{} is {}, expected a finite weight of 0 or more (counted from 0)",
                              where(weights, f, static_cast<std::int64_t>(m)), frame[m]));
    }
  }
  if (std::any_of(weights.values.begin(), weights.values.end(), [](double w) { return w > 0.0; })) return {};
  return fail(ErrorCode::out_of_range, file.string(),
              "has no weight above 0, expected at least one channel that is to be used");
}

Result<SampleArray> read_weights(const fs::path& file, int channels, std::int64_t frames) {
  auto weights = read_samples(file);
  if (!weights) return weights;
  if (auto ok = check_channels(file, *weights, channels); !ok) return tl::unexpected(std::move(ok.error()));
  if (weights->has_frame_axis && weights->frames != frames) {
    return fail(ErrorCode::mismatch, file.string(),
                fmt::format("has {} frames, expected {} as the samples have, or shape (M,)", weights->frames, frames));
  }
  if (auto ok = check_weights(file, *weights); !ok) return tl::unexpected(std::move(ok.error()));
  return weights;
}

std::vector<double> largest_by_channel(const SampleArray& weights) {
  std::vector<double> largest(static_cast<std::size_t>(weights.channels), 0.0);
  for (std::int64_t f = 0; f < weights.frames; ++f) {
    const auto frame = weights.frame(f);
    for (std::size_t m = 0; m < frame.size(); ++m) largest[m] = std::max(largest[m], frame[m]);
  }
  return largest;
}

/// Only weights that vary from frame to frame leave anything.
void set_remaining(const SampleArray& weights, std::span<const double> largest, std::span<const std::int32_t> seeing,
                   FrameInputs& inputs) {
  if (!weights.has_frame_axis) return;
  inputs.weights.assign(weights.values.size(), 1.0F);
  for (std::int64_t f = 0; f < weights.frames; ++f) {
    const auto frame = weights.frame(f);
    const std::size_t first = static_cast<std::size_t>(f) * inputs.channels;
    int reweighted = 0;
    for (const std::int32_t channel : seeing) {
      const auto m = static_cast<std::size_t>(channel);
      if (!(largest[m] > 0.0)) continue;  // its row is zero now
      const auto share = static_cast<float>(frame[m] / largest[m]);
      inputs.weights[first + m] = share;
      reweighted += share == 1.0F ? 0 : 1;
    }
    inputs.max_reweighted = std::max(inputs.max_reweighted, reweighted);
  }
  if (inputs.max_reweighted == 0) inputs.weights.clear();
}

Result<void> set_samples(const fs::path& file, const SampleArray& samples, const SampleArray* weights,
                         FrameInputs& inputs) {
  inputs.samples.reserve(samples.values.size());
  for (std::int64_t f = 0; f < samples.frames; ++f) {
    const auto frame = samples.frame(f);
    const auto weight = weights == nullptr ? std::span<const double>() : weights->frame(weights->frames == 1 ? 0 : f);
    for (std::size_t m = 0; m < frame.size(); ++m) {
      if (!weight.empty() && weight[m] == 0.0) {
        inputs.samples.push_back(0.0F);
        continue;
      }
      const double scaled = frame[m] * (inputs.row_scale.empty() ? 1.0 : inputs.row_scale[m]);
      if (!std::isfinite(scaled) || std::abs(scaled) > std::numeric_limits<float>::max()) {
        return fail(ErrorCode::out_of_range, file.string(),
                    fmt::format("{} is {}, expected a finite sample{} (counted from 0); give it the weight 0 with "
                                "--weights to leave it out",
                                where(samples, f, static_cast<std::int64_t>(m)), frame[m],
                                std::isfinite(frame[m]) ? " within float32" : ""));
      }
      inputs.samples.push_back(static_cast<float>(scaled));
    }
  }
  return {};
}

}  // namespace

std::span<const float> FrameInputs::samples_of(std::int64_t frame) const noexcept {
  return std::span(samples).subspan(static_cast<std::size_t>(frame) * channels, channels);
}

std::span<const float> FrameInputs::weights_of(std::int64_t frame) const noexcept {
  if (weights.empty()) return {};
  return std::span(weights).subspan(static_cast<std::size_t>(frame) * channels, channels);
}

Result<FrameInputs> read_frame_inputs(const recon::Response& response, const fs::path& samples_file,
                                      const fs::path& weights_file) {
  const auto samples = read_samples(samples_file);
  if (!samples) return tl::unexpected(samples.error());
  if (auto ok = check_channels(samples_file, *samples, response.rows()); !ok) {
    return tl::unexpected(std::move(ok.error()));
  }
  FrameInputs inputs;
  inputs.frames = samples->frames;
  inputs.has_frame_axis = samples->has_frame_axis;
  inputs.channels = static_cast<std::size_t>(samples->channels);
  std::optional<SampleArray> weights;
  if (!weights_file.empty()) {
    auto read = read_weights(weights_file, response.rows(), samples->frames);
    if (!read) return tl::unexpected(std::move(read.error()));
    weights = std::move(*read);
    std::vector<double> largest = largest_by_channel(*weights);
    set_remaining(*weights, largest, response.seeing_rows(), inputs);
    if (std::any_of(largest.begin(), largest.end(), [](double w) { return w != 1.0; })) {
      for (double& each : largest) each = std::sqrt(each);
      inputs.row_scale = std::move(largest);
    }
  }
  if (auto ok = set_samples(samples_file, *samples, weights ? &*weights : nullptr, inputs); !ok) {
    return tl::unexpected(std::move(ok.error()));
  }
  return inputs;
}

recon::Response scaled_response(recon::Response response, const FrameInputs& inputs) {
  if (inputs.row_scale.empty()) return response;
  std::vector<std::int32_t> all(static_cast<std::size_t>(response.rows()));
  std::iota(all.begin(), all.end(), 0);
  return response.select_rows(all, inputs.row_scale);
}

}  // namespace compueye::firmware
