#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "firmware/app/option_list.hpp"
#include "firmware/files/npy.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// How near a frame came to the truth.
struct FrameQuality {
  double nmse = 0.0;
  double psnr_db = 0.0;
  double ssim = 0.0;
};

/// The true picture of each frame; one picture may be the truth of all.
class Truth {
 public:
  /// Errors: those of read_pictures(); mismatch (size, number of pictures); out_of_range (NaN, infinity or beyond
  /// float32, named by its index).
  [[nodiscard]] static hal::Result<Truth> read(const std::filesystem::path& file, PictureSize size,
                                               std::int64_t frames);

  [[nodiscard]] hal::Result<FrameQuality> compare(std::int64_t frame, std::span<const float> picture) const;

 private:
  PictureSize size_;
  std::int64_t pictures_ = 1;
  std::vector<float> pixels_;
};

}  // namespace compueye::firmware
