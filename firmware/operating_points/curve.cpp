#include "firmware/operating_points/curve.hpp"

#include <fmt/format.h>

#include "recon/option_names.hpp"
#include "recon/setup/factor.hpp"

namespace compueye::firmware {

std::string_view name(Motion motion) noexcept {
  switch (motion) {
    case Motion::none:
      return "none";
    case Motion::still:
      return "still";
    case Motion::sprite:
      return "sprite";
  }
  return "none";
}

std::string title(const Curve& curve) {
  std::string text(recon::name(curve.solver));
  if (curve.solver != recon::SolverKind::tikhonov && curve.solver != recon::SolverKind::tsvd) {
    text += ' ';
    text += recon::name(curve.basis);
  }
  if (curve.precision == recon::Precision::f64) text += " f64";
  if (curve.op) text += ", " + std::string(recon::name(*curve.op));
  if (curve.threads > 1) text += fmt::format(", {} threads", curve.threads);
  return curve.motion == Motion::none ? text : text + ", warm, " + std::string(name(curve.motion));
}

Board with_curve(const Board& board, const Curve& curve) {
  Board other = board;
  ReconstructionSettings& settings = other.reconstruction;
  settings.solver = curve.solver;
  settings.basis = curve.basis;
  settings.constraint = curve.constraint;
  settings.op = curve.op;
  settings.warm_start = curve.motion != Motion::none;
  settings.threads = curve.threads;
  // Both were chosen for the board's own solver and basis; rho means the same where solver and metric are the same.
  settings.lambda = std::nullopt;
  if (curve.solver != board.reconstruction.solver ||
      recon::metric_of(curve.basis) != recon::metric_of(board.reconstruction.basis)) {
    settings.rho = std::nullopt;
  }
  return other;
}

}  // namespace compueye::firmware
