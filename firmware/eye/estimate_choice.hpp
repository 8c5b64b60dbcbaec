#pragma once

#include <optional>

#include "calib/eye_file/eye_file.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// An estimate is of a distance that is no further from its own.
inline constexpr double same_distance_mm = 0.01;

/// Which of a file's estimates the rows at a distance are from: one that is of it, or two that it lies between.
struct EstimateChoice {
  calib::StoredEstimate nearer;                ///< of both, or the only one
  std::optional<calib::StoredEstimate> other;  ///< there: rows have to be interpolated, both keep what makes them
};

/// The newest at that distance; else the newest at the next nearer and at the next farther distance that keep what
/// their rows are made of. The newest of all where no distance is given. Errors: those of EyeFile; not_found (no
/// estimate), mismatch (none fits: those there are, and what is between them, are named).
[[nodiscard]] hal::Result<EstimateChoice> choose_estimate(const calib::EyeFile& file,
                                                          std::optional<double> distance_mm);

/// Between which distances there are rows at any. Nothing: fewer than two keep what makes theirs.
struct DistanceRange {
  double from_mm = 0.0, to_mm = 0.0;
};
[[nodiscard]] hal::Result<std::optional<DistanceRange>> interpolated_range(const calib::EyeFile& file);

}  // namespace compueye::firmware
