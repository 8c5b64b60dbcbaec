#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "firmware/operating_points/measured_points.hpp"

namespace compueye::firmware {

/// Which stored points a deadline asks for.
struct PointChoice {
  double deadline_ms = 0.0;
  double age_ms = 0.0;              ///< predicted for the chosen point: exposure, waiting, 99.9th percentile of solving
  bool fits = false;                ///< false: not even the fastest point leaves the head-room
  bool keeps_up = false;            ///< false: no point worth a picture is as quick as frames come
  std::size_t level = 0;            ///< of the sweep: that whose sigma is nearest
  std::vector<std::size_t> ladder;  ///< indices of points: the chosen one, then faster and faster ones to step down to;
                                    ///< empty: no point is better than the conventional eye
  std::uint64_t memory_bytes = 0;   ///< tables and workspaces of the ladder; points of one curve share theirs
};

inline constexpr std::size_t most_rungs = 4;
inline constexpr double worth_share = 0.75;   ///< of the conventional eye's NMSE: a mean hides scenes it is better at
inline constexpr double rung_speed_up = 1.5;  ///< each rung's 99.9th percentile is at least so many times shorter
inline constexpr std::uint64_t most_ladder_bytes = std::uint64_t{512} << 20U;  ///< beyond the chosen point

/// The most accurate stored point (mean NMSE at the noise level nearest to `sigma`) whose 99.9th percentile of frame
/// time keeps the predicted age within deadline_share of the deadline, and what to step down to. The age is that of
/// choose_iterations(). A warm start counts with what it made of a scene in which something moves. Points with more
/// than worth_share of the conventional eye's NMSE, or whose median is longer than a frame period, are not chosen. When
/// nothing fits, the most accurate of those whose pictures are nearly as young as the fastest's. `sweep` has points.
[[nodiscard]] PointChoice choose_points(const Sweep& sweep, double sigma, double deadline_ms, double period_ms);

/// Says which point was chosen and why.
[[nodiscard]] std::string sentence(const PointChoice& choice, const Sweep& sweep);

/// "admm dct, 30 iterations"
[[nodiscard]] std::string point_text(const MeasuredPoint& point);

}  // namespace compueye::firmware
