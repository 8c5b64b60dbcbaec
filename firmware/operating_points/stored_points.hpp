#pragma once

#include <cstdint>
#include <string>

#include "firmware/operating_points/measured_points.hpp"
#include "firmware/text/figures.hpp"
#include "hal/result.hpp"
#include "recon/problem/response.hpp"

namespace compueye::firmware {

/// What stored points must have been measured with to be good for a board.
struct PointsKey {
  std::uint64_t response_hash = 0;
  Machine machine;
  recon::ConstraintKind constraint = recon::ConstraintKind::none;
  double lo = 0.0, hi = 1.0;
};
[[nodiscard]] PointsKey points_key(const Board& board, const recon::Response& living);

/// Every figure of a sweep: what `pareto --json` prints.
[[nodiscard]] Figures figures_of(const Sweep& sweep);

/// "<folder>/accuracy-and-time.json"
[[nodiscard]] std::string points_path(const std::string& folder);

/// Stores atomically, replacing what is there; makes the folder. The file is JSON of figures_of() with format and
/// version before them. Errors: those of AtomicFile.
[[nodiscard]] hal::Result<void> store_points(const std::string& folder, const Sweep& sweep);

/// Errors: not_found (none stored), stale (another response, machine, build or constraint, or a machine that was busy:
/// the sentence says which), bad_format (a member that is missing, of another type, or has a name that this program
/// does not know), io.
[[nodiscard]] hal::Result<Sweep> load_points(const std::string& folder, const PointsKey& key);

}  // namespace compueye::firmware
