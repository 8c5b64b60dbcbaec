#pragma once

#include <cstdint>
#include <filesystem>

#include "hal/result.hpp"
#include "recon/response.hpp"

namespace compueye::firmware {

/// The largest dense .npy that is written without being asked twice: 1 GiB.
inline constexpr std::uint64_t default_max_dense_bytes = std::uint64_t{1} << 30U;

/// A response from .npy (dense, stays dense however sparse it is) or .mtx. Errors: usage (other extension), those of
/// read_matrix() and read_matrix_market(), out_of_range (NaN or infinity, named by row and column).
[[nodiscard]] hal::Result<recon::Response> read_response(const std::filesystem::path& path);

/// Writes .npy (dense, float32, shape (M, N)) or .mtx (sparse, exact), atomically. A dense file of more than
/// `max_bytes` is refused with no_space before anything is written. A value beyond float32 is out_of_range.
[[nodiscard]] hal::Result<void> write_response(const std::filesystem::path& path, const recon::Response& response,
                                               std::uint64_t max_bytes = default_max_dense_bytes);

/// Whether write_response() would take a response of this size under this name, asked before it is computed. Errors:
/// usage (other extension), no_space (dense and larger than `max_bytes`).
[[nodiscard]] hal::Result<void> check_response_target(const std::filesystem::path& path, int rows, int cols,
                                                      std::uint64_t max_bytes = default_max_dense_bytes);

}  // namespace compueye::firmware
