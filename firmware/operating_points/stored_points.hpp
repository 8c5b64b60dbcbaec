#pragma once

#include <cstdint>
#include <filesystem>

#include "firmware/operating_points/measured_points.hpp"
#include "hal/result.hpp"
#include "recon/response.hpp"

namespace compueye::firmware {

/// What stored points must have been measured with to be good for a board.
struct PointsKey {
  std::uint64_t response_hash = 0;
  Machine machine;
  recon::ConstraintKind constraint = recon::ConstraintKind::none;
  double lo = 0.0, hi = 1.0;
};
[[nodiscard]] PointsKey points_key(const Board& board, const recon::Response& living);

/// "<folder>/accuracy-and-time.json"
[[nodiscard]] std::filesystem::path points_path(const std::filesystem::path& folder);

/// Stores atomically, replacing what is there; makes the folder. Errors: those of AtomicFile.
[[nodiscard]] hal::Result<void> store_points(const std::filesystem::path& folder, const Sweep& sweep);

/// Errors: not_found (none stored), stale (another response, machine, build or constraint: the sentence says which),
/// bad_format, io.
[[nodiscard]] hal::Result<Sweep> load_points(const std::filesystem::path& folder, const PointsKey& key);

}  // namespace compueye::firmware
