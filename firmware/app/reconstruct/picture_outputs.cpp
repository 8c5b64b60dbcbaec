#include "firmware/app/reconstruct/picture_outputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <utility>

#include "firmware/files/npy_header.hpp"
#include "firmware/files/png.hpp"
#include "hal/image.hpp"

namespace compueye::firmware {
namespace {

hal::Result<void> check_png_size(const OutputRequest& request) {
  if (request.size.rows <= max_png_side && request.size.cols <= max_png_side) return {};
  return hal::fail(hal::ErrorCode::out_of_range, request.png.string(),
                   fmt::format("would be {}x{} pixels, expected at most {} a side; use --out", request.size.rows,
                               request.size.cols, max_png_side));
}

}  // namespace

hal::Result<PictureOutputs> PictureOutputs::create(const OutputRequest& request, InterruptWatch& watch) {
  PictureOutputs outputs(request, watch);
  if (!request.png.empty()) {
    if (auto ok = check_png_size(request); !ok) return tl::unexpected(std::move(ok.error()));
    watch.guard_output(outputs.png_path(0));
    if (auto trial = AtomicFile::create(outputs.png_path(0)); !trial) return tl::unexpected(std::move(trial.error()));
  }
  if (request.npy.empty()) return outputs;
  watch.guard_output(request.npy);
  auto file = AtomicFile::create(request.npy);
  if (!file) return tl::unexpected(std::move(file.error()));
  const std::int64_t shape[] = {request.frames, request.size.rows, request.size.cols};
  const auto axes = std::span<const std::int64_t>(shape).subspan(request.has_frame_axis ? 0 : 1);
  if (auto ok = file->write(format_npy_header(NpyType::f4, axes)); !ok) return tl::unexpected(std::move(ok.error()));
  outputs.npy_.emplace(std::move(*file));
  return outputs;
}

PictureOutputs::~PictureOutputs() {
  std::error_code ignored;
  for (const auto& each : written_) std::filesystem::remove(each, ignored);
}

std::filesystem::path PictureOutputs::png_path(std::int64_t frame) const {
  if (request_.frames == 1) return request_.png;
  std::filesystem::path path = request_.png;
  path.replace_filename(fmt::format("{}-{:04}.png", request_.png.stem().string(), frame));
  return path;
}

hal::Result<void> PictureOutputs::add(std::span<const float> picture) {
  const std::int64_t frame = next_++;
  if (npy_) {
    if (auto ok = npy_->write(std::as_bytes(picture)); !ok) return ok;
  }
  if (request_.png.empty()) return {};
  hal::Image image(request_.size.rows, request_.size.cols);
  std::copy(picture.begin(), picture.end(), image.pixels.begin());
  const std::filesystem::path path = png_path(frame);
  watch_->guard_output(path);
  auto ok = write_png(path, image);
  if (!ok) return ok;
  watch_->guard_part(path);
  written_.push_back(path);
  return {};
}

hal::Result<void> PictureOutputs::commit() {
  if (npy_) {
    if (auto ok = npy_->commit(); !ok) return ok;
  }
  written_.clear();
  return {};
}

}  // namespace compueye::firmware
