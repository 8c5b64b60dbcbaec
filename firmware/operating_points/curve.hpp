#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "firmware/eye/board.hpp"
#include "recon/reconstructor.hpp"

namespace compueye::firmware {

/// What the frames before the judged one showed, for solvers that go on from the last frame.
enum class Motion : std::uint8_t {
  none,    ///< nothing: one frame, solved from a cold start
  still,   ///< the same scene, with fresh noise
  sprite,  ///< the same scene but for a piece of it that comes in from the side
};
[[nodiscard]] std::string_view name(Motion motion) noexcept;

/// One curve of accuracy against time: everything that stays while the iterations grow.
struct Curve {
  recon::SolverKind solver = recon::SolverKind::admm;
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

}  // namespace compueye::firmware
