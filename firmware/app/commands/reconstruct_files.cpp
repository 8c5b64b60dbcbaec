#include "firmware/app/commands/reconstruct_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <numeric>
#include <system_error>

#include "firmware/files/npy.hpp"
#include "firmware/files/npy_header.hpp"
#include "firmware/files/png.hpp"
#include "hal/image.hpp"
#include "hal/try.hpp"
#include "recon/metrics.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::fail;
using hal::Result;

/// "frame 3, channel 17", or the channel alone where the file has no frames.
std::string where(const SampleArray& array, std::int64_t frame, std::int64_t channel) {
  if (!array.has_frame_axis) return fmt::format("channel {}", channel);
  return fmt::format("frame {}, channel {}", frame, channel);
}

Result<void> check_channels(const std::string& file, const SampleArray& array, int channels) {
  if (array.channels == channels) return {};
  return fail(ErrorCode::mismatch, file,
              fmt::format("has {} channels, expected {} as the response has rows{}", array.channels, channels,
                          array.frames == channels ? "; it lies the other way round: save y.T" : ""));
}

Result<void> check_weights(const std::string& file, const SampleArray& weights) {
  for (std::int64_t f = 0; f < weights.frames; ++f) {
    const auto frame = weights.frame(f);
    for (std::size_t m = 0; m < frame.size(); ++m) {
      if (std::isfinite(frame[m]) && frame[m] >= 0.0) continue;
      return fail(ErrorCode::out_of_range, file,
                  fmt::format("{} is {}, expected a finite weight of 0 or more (counted from 0)",
                              where(weights, f, static_cast<std::int64_t>(m)), frame[m]));
    }
  }
  if (std::any_of(weights.values.begin(), weights.values.end(), [](double w) { return w > 0.0; })) return {};
  return fail(ErrorCode::out_of_range, file, "has no weight above 0, expected at least one channel that is to be used");
}

Result<SampleArray> read_weights(const std::string& file, int channels, std::int64_t frames) {
  SampleArray weights = TRY(read_samples(file, channels));
  TRY(check_channels(file, weights, channels));
  if (weights.has_frame_axis && weights.frames != frames) {
    return fail(ErrorCode::mismatch, file,
                fmt::format("has {} frames, expected {} as the samples have, or shape (M,)", weights.frames, frames));
  }
  TRY(check_weights(file, weights));
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

hal::Error no_sample(const std::string& file, const std::string& place, double value, double scaled) {
  return {ErrorCode::out_of_range, file,
          fmt::format("{} is {}, expected a finite sample{} (counted from 0); give it the weight 0 with --weights to "
                      "leave it out",
                      place, value, std::isfinite(scaled) ? " within float32" : "")};
}

/// A sample that is none is NaN for the solver, which gives that frame up. Error: there is one in every frame.
Result<void> set_samples(const std::string& file, const SampleArray& samples, const SampleArray* weights,
                         FrameInputs& inputs) {
  inputs.samples.reserve(samples.values.size());
  inputs.first_sound = samples.frames;
  std::optional<hal::Error> first;
  for (std::int64_t f = 0; f < samples.frames; ++f) {
    bool sound = true;
    const auto frame = samples.frame(f);
    const auto weight = weights == nullptr ? std::span<const double>() : weights->frame(weights->frames == 1 ? 0 : f);
    for (std::size_t m = 0; m < frame.size(); ++m) {
      if (!weight.empty() && weight[m] == 0.0) {
        inputs.samples.push_back(0.0F);
        continue;
      }
      const double scaled = frame[m] * (inputs.row_scale.empty() ? 1.0 : inputs.row_scale[m]);
      const bool fits = std::abs(scaled) <= std::numeric_limits<float>::max();
      inputs.samples.push_back(fits ? static_cast<float>(scaled) : std::numeric_limits<float>::quiet_NaN());
      if (fits) continue;
      sound = false;
      if (!first) first = no_sample(file, where(samples, f, static_cast<std::int64_t>(m)), frame[m], scaled);
    }
    if (sound) inputs.first_sound = std::min(inputs.first_sound, f);
  }
  if (first && inputs.first_sound == samples.frames) return tl::unexpected(*first);
  return {};
}

Result<void> check_png_size(const OutputRequest& request) {
  if (request.size.rows <= max_png_side && request.size.cols <= max_png_side) return {};
  return hal::fail(hal::ErrorCode::out_of_range, request.png,
                   fmt::format("would be {}x{} pixels, expected at most {} a side; use --out", request.size.rows,
                               request.size.cols, max_png_side));
}

}  // namespace

std::span<const float> FrameInputs::samples_of(std::int64_t frame) const noexcept {
  return std::span(samples).subspan(static_cast<std::size_t>(frame) * channels, channels);
}

std::span<const float> FrameInputs::weights_of(std::int64_t frame) const noexcept {
  if (weights.empty()) return {};
  return std::span(weights).subspan(static_cast<std::size_t>(frame) * channels, channels);
}

Result<FrameInputs> read_frame_inputs(const recon::Response& response, const std::string& samples_file,
                                      const std::string& weights_file) {
  const SampleArray samples = TRY(read_samples(samples_file, response.rows()));
  TRY(check_channels(samples_file, samples, response.rows()));
  FrameInputs inputs;
  inputs.frames = samples.frames;
  inputs.has_frame_axis = samples.has_frame_axis;
  inputs.channels = static_cast<std::size_t>(samples.channels);
  std::optional<SampleArray> weights;
  if (!weights_file.empty()) {
    weights = TRY(read_weights(weights_file, response.rows(), samples.frames));
    std::vector<double> largest = largest_by_channel(*weights);
    set_remaining(*weights, largest, response.seeing_rows(), inputs);
    if (std::any_of(largest.begin(), largest.end(), [](double w) { return w != 1.0; })) {
      for (double& each : largest) each = std::sqrt(each);
      inputs.row_scale = std::move(largest);
    }
  }
  TRY(set_samples(samples_file, samples, weights ? &*weights : nullptr, inputs));
  return inputs;
}

recon::Response scaled_response(recon::Response response, const FrameInputs& inputs) {
  if (inputs.row_scale.empty()) return response;
  std::vector<std::int32_t> all(static_cast<std::size_t>(response.rows()));
  std::iota(all.begin(), all.end(), 0);
  return response.select_rows(all, inputs.row_scale);
}

Result<Truth> Truth::read(const std::string& file, PictureSize size, std::int64_t frames) {
  const auto pictures = TRY(read_pictures(file));
  if (pictures.rows != size.rows || pictures.cols != size.cols) {
    return fail(ErrorCode::mismatch, file,
                fmt::format("holds pictures of {}x{} pixels, expected --size {}x{}", pictures.rows, pictures.cols,
                            size.rows, size.cols));
  }
  if (pictures.frames != 1 && pictures.frames != frames) {
    return fail(
        ErrorCode::mismatch, file,
        fmt::format("holds {} pictures, expected 1, or {} as the samples have frames", pictures.frames, frames));
  }
  const auto& values = pictures.values;
  const auto bad = std::find_if(values.begin(), values.end(),
                                [](double v) { return !(std::abs(v) <= std::numeric_limits<float>::max()); });
  if (bad != values.end()) {
    const std::int64_t shape[] = {pictures.frames, pictures.rows, pictures.cols};
    const auto axes = std::span<const std::int64_t>(shape).subspan(pictures.has_frame_axis ? 0 : 1);
    return fail(ErrorCode::out_of_range, file,
                fmt::format("is {} at {}, expected finite intensities (counted from 0)", *bad,
                            index_text(axes, static_cast<std::size_t>(bad - values.begin()))));
  }
  Truth truth;
  const auto pixels = static_cast<std::ptrdiff_t>(size.rows) * size.cols;
  for (auto from = values.begin(); from != values.end(); from += pixels) {
    hal::Image& image = truth.pictures_.emplace_back(size.rows, size.cols);
    std::transform(from, from + pixels, image.pixels.begin(), [](double v) { return static_cast<float>(v); });
  }
  return truth;
}

Result<PictureQuality> Truth::compare(std::int64_t frame, std::span<const float> picture) const {
  const hal::Image& truth = pictures_.size() == 1 ? pictures_.front() : pictures_[static_cast<std::size_t>(frame)];
  return quality_of(recon::PictureView(picture, truth.rows, truth.cols), truth);
}

Result<PictureOutputs> PictureOutputs::create(const OutputRequest& request, Session& session) {
  PictureOutputs outputs(request, session);
  if (!request.png.empty()) {
    TRY(check_png_size(request));
    TRY(try_output(outputs.png_path(0)));
  }
  if (request.npy.empty()) return outputs;
  AtomicFile file = TRY(AtomicFile::create(request.npy));
  const std::int64_t shape[] = {request.frames, request.size.rows, request.size.cols};
  const auto axes = std::span<const std::int64_t>(shape).subspan(request.has_frame_axis ? 0 : 1);
  TRY(file.write(format_npy_header("<f4", axes)));
  outputs.npy_.emplace(std::move(file));
  return outputs;
}

PictureOutputs::~PictureOutputs() {
  std::error_code ignored;
  for (const auto& each : written_) std::filesystem::remove(each, ignored);
}

std::string PictureOutputs::png_path(std::int64_t frame) const {
  if (request_.frames == 1) return request_.png;
  std::filesystem::path path = request_.png;
  path.replace_filename(fmt::format("{}-{:04}.png", path.stem().string(), frame));
  return path.string();
}

Result<std::int64_t> PictureOutputs::add(std::span<const float> picture) {
  const std::int64_t frame = next_++;
  if (npy_) TRY(npy_->write(std::as_bytes(picture)));
  if (request_.png.empty()) return 0;
  hal::Image image(request_.size.rows, request_.size.cols);
  std::copy(picture.begin(), picture.end(), image.pixels.begin());
  const std::string path = png_path(frame);
  TRY(write_png(path, image));
  session_->guard_part(path);
  written_.push_back(path);
  // Half a code of 8 bits is lost in rounding anyway.
  constexpr float unseen = 0.5F / 255.0F;
  return std::count_if(picture.begin(), picture.end(), [](float v) { return v < -unseen || v > 1.0F + unseen; });
}

Result<void> PictureOutputs::commit() {
  if (npy_) TRY(npy_->commit());
  written_.clear();
  return {};
}

}  // namespace compueye::firmware
