#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/eye/board.hpp"
#include "firmware/eye/picture_quality.hpp"
#include "firmware/operating_points/machine.hpp"
#include "recon/option_names.hpp"
#include "recon/reconstructor.hpp"

namespace compueye::firmware {

/// What the frames before the judged one showed, for solvers that go on from the last frame.
enum class Motion : std::uint8_t {
  none,    ///< nothing: one frame, solved from a cold start
  still,   ///< the same scene, with fresh noise
  sprite,  ///< the same scene but for a piece of it that comes in from the side
};
[[nodiscard]] std::span<const recon::Named<Motion>> motion_names() noexcept;
[[nodiscard]] std::string_view name(Motion motion) noexcept;

/// One curve of accuracy against time: everything that stays while the iterations grow.
struct Curve {
  recon::SolverKind solver = recon::default_solver();
  recon::BasisKind basis = recon::BasisKind::identity;
  recon::ConstraintKind constraint = recon::ConstraintKind::none;
  recon::Precision precision = recon::Precision::f32;
  std::optional<recon::OperatorKind> op = std::nullopt;  ///< absent: the quickest form of A
  Motion motion = Motion::none;  ///< of the frames that a warm start goes on from; none: every frame starts cold
  int threads = 1;

  bool operator==(const Curve&) const = default;
};

/// "admm dct", "admm dct f64", "pdhg dct, dense runs in int8", "pdhg dct, warm, still", "pdhg dct, 2 threads":
/// what a legend says.
[[nodiscard]] std::string title(const Curve& curve);

/// The board as it would be if its file named this curve.
[[nodiscard]] Board with_curve(const Board& board, const Curve& curve);

/// How good the pictures of several scenes are: on the mean, and what nine of ten scenes reach (nearest rank on the bad
/// side: the 90th percentile of NMSE, the 10th of PSNR and SSIM).
struct QualitySummary {
  PictureQuality mean;
  PictureQuality nine_in_ten;
};
/// Of at least one picture.
[[nodiscard]] QualitySummary summarise(std::span<const PictureQuality> pictures);

/// A dark or a bright day: noise as a multiple of the board's own.
struct NoiseLevel {
  double times = 1.0;
  double sigma = 0.0;  ///< of one sample, in white pixels: all that the rule for lambda is told
};

/// What a point is worth at one noise level.
struct LevelFigures {
  double times = 0.0;  ///< the board's own noise
  double sigma = 0.0;
  double lambda = 0.0;  ///< by rule
  QualitySummary quality;
};

/// One way of turning y into x, what it is worth and what it costs on this machine.
struct MeasuredPoint {
  Curve curve;
  recon::OperatorKind op = recon::OperatorKind::csr;
  int iterations = 0;
  std::vector<LevelFigures> levels;  ///< the board's own noise first
  QualitySummary overall;            ///< over scenes and levels
  double objective = 0.0;            ///< mean over the scenes of the first level
  double median_ms = 0.0;
  double p999_ms = 0.0;  ///< 99.9th percentile; of fewer than 1000 frames the slowest
  std::uint64_t timed_frames = 0;
  std::uint64_t table_bytes = 0;
  std::uint64_t workspace_bytes = 0;
};

/// Timed frames that had a processor for less of their time were measured on a machine that was busy otherwise: their
/// times are good for nothing but the order of things.
inline constexpr double trusted_processor_share = 0.95;

/// Every point of a board on this machine.
struct Sweep {
  std::string board;
  std::uint64_t response_hash = 0;
  Machine machine;
  recon::ConstraintKind constraint = recon::ConstraintKind::none;  ///< the board's
  double lo = 0.0, hi = 1.0;
  int channels = 0, seeing = 0, image_rows = 0, image_cols = 0;
  std::vector<std::string> scenes;     ///< names, in the order in which they take turns
  std::uint64_t first_scene_seed = 0;  ///< each scene after it has the next one
  std::size_t pictures_a_level = 0;
  std::vector<NoiseLevel> levels;
  std::vector<QualitySummary> conventional;  ///< by level; empty for a lattice that has none
  std::vector<MeasuredPoint> points;
  std::size_t planned = 0;       ///< points of the table, those included that were left out for a reason
  double processor_share = 1.0;  ///< processor time over wall time of the timed frames; below one when disturbed
  std::string cut_short;         ///< why points of the table are missing that should not be; empty: none are
  std::vector<std::string> notes;
};

/// What a point costs and what it is worth: less of each is better.
struct CostAndError {
  double cost = 0.0;
  double error = 0.0;
};

/// The efficient points' indices in order of rising cost, hence of falling error: each errs by more than `least_gain`
/// of its error (0 = any gain) less than every point that costs no more. Of equal points the first counts. A point with
/// a NaN or an infinity is never efficient and outdoes nobody.
[[nodiscard]] std::vector<std::size_t> efficient_front(std::span<const CostAndError> points, double least_gain = 0.0);

/// The points that no other outdoes in cost (the median time, or another member) and, by more than a hundredth, in mean
/// NMSE at `level` (sweep.levels.size(): overall), by cost.
/// A warm start on a still scene is none of them: it is the best that can happen, not what can be counted on.
[[nodiscard]] std::vector<std::size_t> efficient_points(const Sweep& sweep, std::size_t level,
                                                        double MeasuredPoint::*cost = &MeasuredPoint::median_ms);

}  // namespace compueye::firmware
