#include "firmware/app/reconstruct/picture_outputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "firmware/files/npy_header.hpp"
#include "firmware/files/png.hpp"
#include "hal/image.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

hal::Result<void> check_png_size(const OutputRequest& request) {
  if (request.size.rows <= max_png_side && request.size.cols <= max_png_side) return {};
  return hal::fail(hal::ErrorCode::out_of_range, request.png,
                   fmt::format("would be {}x{} pixels, expected at most {} a side; use --out", request.size.rows,
                               request.size.cols, max_png_side));
}

}  // namespace

hal::Result<PictureOutputs> PictureOutputs::create(const OutputRequest& request, Session& session) {
  PictureOutputs outputs(request, session);
  if (!request.png.empty()) {
    TRY(check_png_size(request));
    session.guard_output(outputs.png_path(0));
    TRY(try_output(outputs.png_path(0)));
  }
  if (request.npy.empty()) return outputs;
  session.guard_output(request.npy);
  AtomicFile file = TRY(AtomicFile::create(request.npy));
  const std::int64_t shape[] = {request.frames, request.size.rows, request.size.cols};
  const auto axes = std::span<const std::int64_t>(shape).subspan(request.has_frame_axis ? 0 : 1);
  TRY(file.write(format_npy_header(NpyType::f4, axes)));
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

hal::Result<void> PictureOutputs::add(std::span<const float> picture) {
  const std::int64_t frame = next_++;
  if (npy_) TRY(npy_->write(std::as_bytes(picture)));
  if (request_.png.empty()) return {};
  hal::Image image(request_.size.rows, request_.size.cols);
  std::copy(picture.begin(), picture.end(), image.pixels.begin());
  const std::string path = png_path(frame);
  session_->guard_output(path);
  TRY(write_png(path, image));
  session_->guard_part(path);
  written_.push_back(path);
  return {};
}

hal::Result<void> PictureOutputs::commit() {
  if (npy_) TRY(npy_->commit());
  written_.clear();
  return {};
}

}  // namespace compueye::firmware
