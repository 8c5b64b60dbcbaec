#pragma once

#include <cstdint>
#include <span>

#include "hal/image.hpp"
#include "hal/result.hpp"

namespace compueye::recon {

/// A grey picture somebody else owns: linear intensity, row-major, row 0 on top, rows * cols pixels.
struct PictureView {
  std::span<const float> pixels;
  int rows = 0;
  int cols = 0;

  PictureView(std::span<const float> pixels_, int rows_, int cols_) : pixels(pixels_), rows(rows_), cols(cols_) {}
  PictureView(const hal::Image& image) : pixels(image.pixels), rows(image.rows), cols(image.cols) {}  // NOLINT: a view
};

// All figures are computed in double. Errors of each: mismatch (two pictures of different size, or pixels that are not
// rows * cols), out_of_range (no pixels; a NaN or infinity, named by picture, row and column).

/// Normalised mean squared error ||x - t||^2 / ||t||^2 of picture x against truth t. 0 is perfect, 1 is as bad as
/// black. An all-black truth: 0 for an all-black picture, infinity for any other.
[[nodiscard]] hal::Result<double> nmse(const PictureView& picture, const PictureView& truth);

/// Peak signal-to-noise ratio 10 log10(peak^2 / mean((x - t)^2)) in dB; infinity for equal pictures.
/// Further error: usage (peak not positive and finite).
[[nodiscard]] hal::Result<double> psnr(const PictureView& picture, const PictureView& truth, double peak = 1.0);

/// Mean structural similarity, -1 to 1, 1 for equal pictures.
/// Source: Wang, Bovik, Sheikh, Simoncelli, "Image Quality Assessment: From Error Visibility to Structural
/// Similarity", IEEE Trans. Image Processing 13 (2004), eq. 13 to 17: an 11 x 11 Gaussian window of sigma 1.5
/// normalised to sum 1, K1 = 0.01, K2 = 0.03, dynamic range L = 1; the mean is over the positions where the window lies
/// wholly inside. A picture with fewer than 11 rows (columns) gets a window with as many rows (columns) as it has,
/// centred on the picture, of the same sigma and again normalised.
[[nodiscard]] hal::Result<double> ssim(const PictureView& picture, const PictureView& truth);

/// Michelson contrast (Imax - Imin) / (Imax + Imin) of a bar target, with Imax and Imin the mean of the pixels on the
/// bright and on the dark bars (flat indices). 1 is perfect, 0 is no contrast, negative is a reversed one; an all-black
/// picture has 0. With negative pixels it can exceed 1. Further errors: usage (no bright or no dark pixels),
/// out_of_range (index outside the picture; the means cancel, so that there is no contrast to speak of).
[[nodiscard]] hal::Result<double> michelson_contrast(const PictureView& picture, std::span<const std::int32_t> bright,
                                                     std::span<const std::int32_t> dark);

}  // namespace compueye::recon
