#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "firmware/app/option_list.hpp"
#include "firmware/app/session.hpp"
#include "firmware/eye/picture_quality.hpp"
#include "firmware/files/atomic_file.hpp"
#include "hal/image.hpp"
#include "hal/result.hpp"
#include "recon/problem/response.hpp"

namespace compueye::firmware {

/// Samples and weights as the solver takes them. A channel's weights are split in two: the largest over all frames goes
/// into its row and samples (both times its square root), because that costs nothing; what remains, 0..1, goes to
/// solve() frame by frame.
struct FrameInputs {
  std::int64_t frames = 1;
  bool has_frame_axis = false;    ///< whether the samples came as (frames, M)
  std::size_t channels = 0;       ///< M
  std::vector<float> samples;     ///< frames * M, scaled; 0 where the weight is, NaN for what is no sample
  std::int64_t first_sound = 0;   ///< the first frame without such a NaN
  std::vector<float> weights;     ///< frames * M of 0..1, what remains of the weights; empty: one everywhere
  std::vector<double> row_scale;  ///< M square roots of the largest weights; empty: one everywhere
  int max_reweighted = 0;         ///< most seeing channels of a frame whose remaining weight is not one

  [[nodiscard]] std::span<const float> samples_of(std::int64_t frame) const noexcept;
  /// Empty when all are one.
  [[nodiscard]] std::span<const float> weights_of(std::int64_t frame) const noexcept;
};

/// `weights` may be an empty path. Weights of shape (M,) hold for every frame.
/// Errors: those of read_samples(); mismatch (channels that are not the response's rows, frames that differ);
/// out_of_range (NaN or infinity in every frame, in a sample whose weight is not 0; a weight that is negative or not
/// finite, all weights 0), naming file, frame and channel.
[[nodiscard]] hal::Result<FrameInputs> read_frame_inputs(const recon::Response& response, const std::string& samples,
                                                         const std::string& weights);

/// The response with each row times its row_scale.
[[nodiscard]] recon::Response scaled_response(recon::Response response, const FrameInputs& inputs);

/// The true picture of each frame; one picture may be the truth of all.
class Truth {
 public:
  /// Errors: those of read_pictures(); mismatch (size, number of pictures); out_of_range (NaN, infinity or beyond
  /// float32, named by its index).
  [[nodiscard]] static hal::Result<Truth> read(const std::string& file, PictureSize size, std::int64_t frames);

  [[nodiscard]] hal::Result<PictureQuality> compare(std::int64_t frame, std::span<const float> picture) const;

 private:
  std::vector<hal::Image> pictures_;  // one, or one a frame
};

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

  /// The next frame. Returns how many of its pixels lie beyond 0..1, so that a PNG shows them as black or white.
  [[nodiscard]] hal::Result<std::int64_t> add(std::span<const float> picture);
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
