#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hal/result.hpp"

namespace compueye::firmware {

/// Numbers read from a NumPy .npy file, in C order.
struct NpyArray {
  std::vector<std::int64_t> shape;
  std::vector<double> values;
};

/// Reads an .npy file (format versions 1.0, 2.0 and 3.0) of f2, f4, f8, i1..i8, u1..u8 or b1 elements of either byte
/// order, in C or Fortran order, with `min_dims` to `max_dims` dimensions, none of them of length zero. Every element
/// arrives exactly: an integer that a double cannot hold (beyond 2^53) is an error that names it. NaN and infinity are
/// let through, because only the caller knows whether a channel is masked: see first_non_finite().
///
/// Errors, each naming the file, what was found and what was expected: not_found, io; bad_format (not an .npy file,
/// truncated, trailing bytes); unsupported (complex, string, object, structured: the sentence names the NumPy call that
/// converts it); mismatch (dimensions); out_of_range (empty, inexact integer).
[[nodiscard]] hal::Result<NpyArray> read_npy(const std::string& path, int min_dims, int max_dims);

/// A matrix, shape (rows, cols).
[[nodiscard]] hal::Result<NpyArray> read_matrix(const std::string& path);

/// Samples y: (M,) for one frame, or (frames, M). One frame may also be a column, (M, 1), where M is `channels`.
struct SampleArray {
  std::int64_t frames = 1;
  std::int64_t channels = 0;    ///< M
  bool has_frame_axis = false;  ///< whether the file had the frames axis, so that results can be written alike
  std::vector<double> values;   ///< frames * channels

  [[nodiscard]] std::span<const double> frame(std::int64_t f) const noexcept {
    return std::span(values).subspan(static_cast<std::size_t>(f * channels), static_cast<std::size_t>(channels));
  }
};
[[nodiscard]] hal::Result<SampleArray> read_samples(const std::string& path, std::int64_t channels);

/// Pictures x: (H, W), or (frames, H, W).
struct PictureArray {
  std::int64_t frames = 1;
  std::int64_t rows = 0;
  std::int64_t cols = 0;
  bool has_frame_axis = false;
  std::vector<double> values;  ///< frames * rows * cols
};
[[nodiscard]] hal::Result<PictureArray> read_pictures(const std::string& path);

/// Flat index of the first NaN or infinity.
[[nodiscard]] std::optional<std::size_t> first_non_finite(std::span<const double> values) noexcept;

/// Where a flat index lies in an array, for messages: "(2, 17)", counted from 0.
[[nodiscard]] std::string index_text(std::span<const std::int64_t> shape, std::size_t flat);

/// Writes an array as little-endian C-order .npy, version 1.0, atomically. Errors: usage (shape and values differ in
/// size), and those of AtomicFile.
[[nodiscard]] hal::Result<void> write_npy(const std::string& path, std::span<const std::int64_t> shape,
                                          std::span<const float> values);
[[nodiscard]] hal::Result<void> write_npy(const std::string& path, std::span<const std::int64_t> shape,
                                          std::span<const double> values);

}  // namespace compueye::firmware
