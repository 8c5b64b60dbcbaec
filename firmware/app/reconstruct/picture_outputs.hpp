#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "firmware/app/option_list.hpp"
#include "firmware/app/session.hpp"
#include "firmware/files/atomic_file.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

struct OutputRequest {
  std::string npy;  ///< empty: none
  std::string png;  ///< empty: none
  PictureSize size;
  std::int64_t frames = 1;
  bool has_frame_axis = false;
};

/// The reconstructed pictures as files: all of them or, without commit(), none.
class PictureOutputs {
 public:
  /// Begins the .npy and tries whether the PNGs can be written, so that a long computation does not end in an error
  /// that could have been told at once. Errors: those of AtomicFile; out_of_range (a side too long for PNG).
  [[nodiscard]] static hal::Result<PictureOutputs> create(const OutputRequest& request, Session& session);

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
  explicit PictureOutputs(OutputRequest request, Session& session) : request_(std::move(request)), session_(&session) {}
  [[nodiscard]] std::string png_path(std::int64_t frame) const;

  OutputRequest request_;
  Session* session_;
  std::optional<AtomicFile> npy_;
  std::vector<std::string> written_;
  std::int64_t next_ = 0;
};

}  // namespace compueye::firmware
