#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "hal/result.hpp"
#include "recon/core/bases/basis.hpp"
#include "recon/problem/progress.hpp"
#include "recon/problem/response.hpp"

namespace compueye::recon {

/// K0 of the quadratic step (core/metric.hpp).
enum class MetricKind : std::uint8_t { identity, smoothing };

[[nodiscard]] constexpr MetricKind metric_of(BasisKind basis) noexcept {
  return basis == BasisKind::tv ? MetricKind::smoothing : MetricKind::identity;
}

/// What makes a frame cheap, made in double, kept in float32, and worth storing: it is the slow part of setting up a
/// solver. Either the inverse packed_inverse() of the seeing rows, a packed upper triangle by rows for each
/// parity class, one after the other; or, for pdhg, the leading modes of A A' (recon/setup/leading_modes.hpp). The
/// inverse of a tall response is made within seconds, and not kept: order 0.
struct Factor {
  double rho = 0.0;           ///< of an inverse; modes serve every rho
  int order = 0;              ///< number of seeing rows
  std::vector<float> values;  ///< factor_size() or modes_size() of its classes
  MetricKind metric = MetricKind::identity;
  int rank = 0;            ///< how many modes, 0: it is an inverse
  bool from_file = false;  ///< tried (recon/setup/factor_check.hpp) before it is believed
};

class ParityClasses;

/// Values that the triangles of all classes take.
[[nodiscard]] std::size_t factor_size(const ParityClasses& classes) noexcept;

/// (S (A K0^-1 A' + rho I) S)^-1, S the loud_row_scale() (recon/setup/row_norms.hpp), computed in double, packed as
/// Factor::values are, rounded once to T. `seeing` has no blind rows; rho > 0. Errors: interrupted; out_of_range when
/// rho is too small for the matrix to be inverted in double or its inverse to be kept in T (condition number times
/// rounding error of T above a half).
template <class T>
[[nodiscard]] hal::Result<std::vector<T>> packed_inverse(const Response& seeing, MetricKind metric, double rho,
                                                         const Progress& progress);

/// A'A + rho K0 of a tall response, and its inverse, packed upper triangles by rows, from A = Q R in double.
struct PixelFactor {
  std::vector<double> matrix, inverse;
};

/// `rounding` is that of the frame's numbers, half their epsilon. Errors: as above.
[[nodiscard]] hal::Result<PixelFactor> pixel_factor(const Response& seeing, MetricKind metric, double rho,
                                                    double rounding, const Progress& progress);

}  // namespace compueye::recon
