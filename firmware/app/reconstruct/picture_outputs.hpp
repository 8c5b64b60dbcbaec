#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "firmware/app/interrupt/interrupt_watch.hpp"
#include "firmware/app/options/value_text.hpp"
#include "firmware/files/atomic_file.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

struct OutputRequest {
  std::filesystem::path npy;  ///< empty: none
  std::filesystem::path png;  ///< empty: none
  PictureSize size;
  std::int64_t frames = 1;
  bool has_frame_axis = false;
};

/// The reconstructed pictures as files: all of them or, without commit(), none.
class PictureOutputs {
 public:
  /// Begins the .npy and tries whether the PNGs can be written, so that a long computation does not end in an error
  /// that could have been told at once. Errors: those of AtomicFile; out_of_range (a side too long for PNG).
  [[nodiscard]] static hal::Result<PictureOutputs> create(const OutputRequest& request, InterruptWatch& watch);

  PictureOutputs(const PictureOutputs&) = delete;
  PictureOutputs& operator=(const PictureOutputs&) = delete;
  PictureOutputs(PictureOutputs&&) = default;
  PictureOutputs& operator=(PictureOutputs&&) = delete;
  /// Without commit(), PNGs already written are removed.
  ~PictureOutputs();

  /// The next frame.
  [[nodiscard]] hal::Result<void> add(std::span<const float> picture);
  [[nodiscard]] hal::Result<void> commit();

 private:
  explicit PictureOutputs(OutputRequest request, InterruptWatch& watch)
      : request_(std::move(request)), watch_(&watch) {}
  [[nodiscard]] std::filesystem::path png_path(std::int64_t frame) const;

  OutputRequest request_;
  InterruptWatch* watch_;
  std::optional<AtomicFile> npy_;
  std::vector<std::filesystem::path> written_;
  std::int64_t next_ = 0;
};

}  // namespace compueye::firmware
