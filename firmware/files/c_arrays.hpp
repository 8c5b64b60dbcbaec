#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "hal/result.hpp"
#include "recon/problem/response.hpp"

namespace compueye::firmware {

/// More than a microcontroller has of flash, and than compilers take of arrays in reasonable time.
inline constexpr std::int64_t most_array_bytes = std::int64_t{16} << 20U;

/// Writes a sparse response as a C header, atomically: sizes as macros COMPUEYE_RESPONSE_..., and constant arrays
/// compueye_response_row_start (uint32_t, M + 1), _columns (int32_t) and _values (float, each with the fewest digits
/// that give back the same one), which are what recon/core/operators/linear_operator.hpp takes of a csr operator. C99
/// and C++. `comment` (any number of lines) goes on top.
///
/// Errors: no_space (more than most_array_bytes of arrays), out_of_range (an entry beyond float32, named), and those of
/// AtomicFile.
[[nodiscard]] hal::Result<void> write_c_arrays(const std::string& path, const recon::Response& response,
                                               std::string_view comment);

}  // namespace compueye::firmware
