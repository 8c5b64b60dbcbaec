#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "hal/result.hpp"
#include "recon/problem/response.hpp"

namespace compueye::firmware {

/// The largest dense .npy that is written without being asked twice: 1 GiB.
inline constexpr std::uint64_t default_max_dense_bytes = std::uint64_t{1} << 30U;

/// A response from .npy (dense, stays dense however sparse it is) or .mtx. Errors: usage (other extension), those of
/// read_matrix() and read_matrix_market(), out_of_range (NaN or infinity, named by row and column).
[[nodiscard]] hal::Result<recon::Response> read_response(const std::string& path);

/// Writes .npy (dense, float32, shape (M, N)) or .mtx (sparse, exact), atomically. A dense file of more than
/// `max_bytes` is refused with no_space before anything is written. A value beyond float32 is out_of_range.
[[nodiscard]] hal::Result<void> write_response(const std::string& path, const recon::Response& response,
                                               std::uint64_t max_bytes = default_max_dense_bytes);

/// Whether write_response() would take a response of this size under this name, asked before it is computed. Errors:
/// usage (other extension), no_space (dense and larger than `max_bytes`).
[[nodiscard]] hal::Result<void> check_response_target(const std::string& path, int rows, int cols,
                                                      std::uint64_t max_bytes = default_max_dense_bytes);

/// Reads a Matrix Market file into a response: sparse from "coordinate", dense from "array".
/// Source: Boisvert, Pozo, Remington, "The Matrix Market Exchange Formats", NISTIR 5935 (1996).
///
/// Accepted: coordinate real / integer / unsigned-integer / pattern (an entry of a pattern is 1), array all but
/// pattern; both general / symmetric / skew-symmetric. Indices count from 1. Entries come in any order; an element
/// given more than once is the sum of its entries, as SciPy, Octave and Eigen read it. Explicit zeros stay stored.
/// Empty lines and a byte order mark are skipped.
///
/// Every error names file and line, the value and what was expected: not_found, io; bad_format (banner, size line,
/// number, fewer or more entries than announced, a first line of more than 1 KiB); out_of_range (index outside the
/// matrix, NaN, infinity, overflow, no entries, or so few that nearly every row or column is empty); unsupported
/// (complex, hermitian, more than 2^24 rows or 2^26 columns).
[[nodiscard]] hal::Result<recon::Response> read_matrix_market(const std::string& path);

/// Writes "coordinate real general", each value with the fewest digits that give back the same double, atomically.
/// A sparse response keeps its stored entries, a dense one is written without its zeros. `comment` (any number of
/// lines) goes below the banner.
[[nodiscard]] hal::Result<void> write_matrix_market(const std::string& path, const recon::Response& response,
                                                    std::string_view comment = {});

}  // namespace compueye::firmware
