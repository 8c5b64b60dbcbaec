#include "firmware/app/reconstruct/frame_quality.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "recon/metrics.hpp"

namespace compueye::firmware {

using hal::ErrorCode;
using hal::fail;

hal::Result<Truth> Truth::read(const std::filesystem::path& file, PictureSize size, std::int64_t frames) {
  const auto pictures = read_pictures(file);
  if (!pictures) return tl::unexpected(pictures.error());
  if (pictures->rows != size.rows || pictures->cols != size.cols) {
    return fail(ErrorCode::mismatch, file.string(),
                fmt::format("holds pictures of {}x{} pixels, expected --size {}x{}", pictures->rows, pictures->cols,
                            size.rows, size.cols));
  }
  if (pictures->frames != 1 && pictures->frames != frames) {
    return fail(
        ErrorCode::mismatch, file.string(),
        fmt::format("holds {} pictures, expected 1, or {} as the samples have frames", pictures->frames, frames));
  }
  const auto& values = pictures->values;
  const auto bad = std::find_if(values.begin(), values.end(),
                                [](double v) { return !(std::abs(v) <= std::numeric_limits<float>::max()); });
  if (bad != values.end()) {
    const std::int64_t shape[] = {pictures->frames, pictures->rows, pictures->cols};
    const auto axes = std::span<const std::int64_t>(shape).subspan(pictures->has_frame_axis ? 0 : 1);
    return fail(ErrorCode::out_of_range, file.string(),
                fmt::format("is {} at {}, expected finite intensities (counted from 0)", *bad,
                            index_text(axes, static_cast<std::size_t>(bad - values.begin()))));
  }
  Truth truth;
  truth.size_ = size;
  truth.pictures_ = pictures->frames;
  truth.pixels_.reserve(values.size());
  for (const double value : values) truth.pixels_.push_back(static_cast<float>(value));
  return truth;
}

hal::Result<FrameQuality> Truth::compare(std::int64_t frame, std::span<const float> picture) const {
  const std::size_t first = pictures_ == 1 ? 0 : static_cast<std::size_t>(frame) * picture.size();
  const recon::PictureView found(picture, size_.rows, size_.cols);
  const std::span<const float> true_pixels = std::span(pixels_).subspan(first, picture.size());
  const recon::PictureView wanted(true_pixels, size_.rows, size_.cols);
  FrameQuality quality;
  const auto done = recon::nmse(found, wanted)
                        .map([&](double v) { quality.nmse = v; })
                        .and_then([&] { return recon::psnr(found, wanted); })
                        .map([&](double v) { quality.psnr_db = v; })
                        .and_then([&] { return recon::ssim(found, wanted); })
                        .map([&](double v) { quality.ssim = v; });
  if (!done) return tl::unexpected(done.error());
  return quality;
}

}  // namespace compueye::firmware
