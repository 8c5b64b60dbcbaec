#pragma once

#include <filesystem>
#include <string_view>

#include "hal/result.hpp"
#include "recon/response.hpp"

namespace compueye::firmware {

/// Reads a Matrix Market file into a response: sparse from "coordinate", dense from "array".
/// Source: Boisvert, Pozo, Remington, "The Matrix Market Exchange Formats", NISTIR 5935 (1996).
///
/// Accepted: coordinate real / integer / pattern (an entry of a pattern is 1), general / symmetric / skew-symmetric;
/// array real / integer general. Indices count from 1. Entries come in any order; an element given more than once
/// is the sum of its entries, as SciPy, Octave and Eigen read it. Explicit zeros stay stored. Empty lines are skipped.
///
/// Every error names file and line, the value and what was expected: not_found, io; bad_format (banner, size line,
/// number, fewer or more entries than announced); out_of_range (index outside the matrix, NaN, infinity, overflow,
/// no entries); unsupported (complex, hermitian, more than 2^24 rows or 2^26 columns).
[[nodiscard]] hal::Result<recon::Response> read_matrix_market(const std::filesystem::path& path);

/// Writes "coordinate real general", each value with the fewest digits that give back the same double, atomically.
/// A sparse response keeps its stored entries, a dense one is written without its zeros. `comment` (any number of
/// lines) goes below the banner.
[[nodiscard]] hal::Result<void> write_matrix_market(const std::filesystem::path& path, const recon::Response& response,
                                                    std::string_view comment = {});

}  // namespace compueye::firmware
