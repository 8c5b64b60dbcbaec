#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "hal/result.hpp"
#include "recon/response.hpp"

namespace compueye::firmware {

/// Samples and weights as the solver takes them. A channel's weights are split in two: the largest over all frames goes
/// into its row and samples (both times its square root), because that costs nothing; what remains, 0..1, goes to
/// solve() frame by frame.
struct FrameInputs {
  std::int64_t frames = 1;
  bool has_frame_axis = false;    ///< whether the samples came as (frames, M)
  std::size_t channels = 0;       ///< M
  std::vector<float> samples;     ///< frames * M, scaled; 0 where the weight is
  std::vector<float> weights;     ///< frames * M of 0..1, what remains of the weights; empty: one everywhere
  std::vector<double> row_scale;  ///< M square roots of the largest weights; empty: one everywhere
  int max_reweighted = 0;         ///< most seeing channels of a frame whose remaining weight is not one

  [[nodiscard]] std::span<const float> samples_of(std::int64_t frame) const noexcept;
  /// Empty when all are one.
  [[nodiscard]] std::span<const float> weights_of(std::int64_t frame) const noexcept;
};

/// `weights` may be an empty path. Weights of shape (M,) hold for every frame.
/// Errors: those of read_samples(); mismatch (channels that are not the response's rows, frames that differ);
/// out_of_range (NaN or infinity in a sample whose weight is not 0, a weight that is negative or not finite, all
/// weights 0), naming file, frame and channel.
[[nodiscard]] hal::Result<FrameInputs> read_frame_inputs(const recon::Response& response,
                                                         const std::filesystem::path& samples,
                                                         const std::filesystem::path& weights);

/// The response with each row times its row_scale.
[[nodiscard]] recon::Response scaled_response(recon::Response response, const FrameInputs& inputs);

}  // namespace compueye::firmware
