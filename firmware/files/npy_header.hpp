#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hal/result.hpp"

namespace compueye::firmware {

/// A kind of plain real number that .npy files hold.
struct NpyType {
  std::string_view code;  ///< "f4"; "<f4" in the file
  std::size_t bytes;      ///< of one element
  /// Appends `count` elements as doubles; the text of the first that is not exact as one (or no boolean), or nothing.
  std::optional<std::string> (*append)(const char* from, std::size_t count, std::vector<double>& out);
};

/// What stands in front of the numbers of an .npy file.
/// Source: NumPy Enhancement Proposal 1, "A simple file format for NumPy arrays", versions 1.0, 2.0 and 3.0.
struct NpyHeader {
  const NpyType* type = nullptr;
  std::vector<std::int64_t> shape;  ///< empty for a single number (0-d)
  bool big_endian = false;          ///< the bytes of each number stand in reverse
  bool fortran = false;             ///< the first index runs fastest, and that makes a difference
};

/// Number of bytes in front of the header's text: magic, version and the text's length.
inline constexpr std::size_t npy_preamble_v1_bytes = 10;
inline constexpr std::size_t npy_preamble_v2_bytes = 12;

/// The dictionary in the header: exactly the keys descr, fortran_order and shape, in any order. What is no plain real
/// number is refused by name with the call that converts it. `path` is for messages.
/// Errors: bad_format (not a header), unsupported (complex, string, object, structured, no byte order).
[[nodiscard]] hal::Result<NpyHeader> parse_npy_header(const std::string& path, std::string_view text);

/// Magic, version 1.0, length and dictionary, padded with spaces to a multiple of 64 bytes, at least `min_bytes`.
/// `descr` is the type as NumPy writes it: "<f4".
[[nodiscard]] std::string format_npy_header(std::string_view descr, std::span<const std::int64_t> shape,
                                            std::size_t min_bytes = 0);

/// "(3, 4)", "(5,)", "()" as NumPy writes it.
[[nodiscard]] std::string shape_text(std::span<const std::int64_t> shape);

}  // namespace compueye::firmware
