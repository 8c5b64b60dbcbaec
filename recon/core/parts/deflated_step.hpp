#pragma once

#include <cstddef>
#include <cstdint>

#include "recon/core/parts/crew.hpp"

namespace compueye::recon::core {

/// The dual step of a primal-dual method whose metric knows the leading modes of A:
///
///   F = f_0 I + U diag(f_k - f_0) U',   f_k = 1 / (1 + tau s_k / (1 - w))
///
/// U are eigenvectors of A A' and s_k their eigenvalues; s_0 bounds those of all other modes. By parity classes
/// (recon/setup/mirror_symmetry.hpp) where A is mirror symmetric, which is a quarter of the work; else one class.
/// Vectors are bfloat16, the upper half of a float32: steps, not results, depend on them. What rounding takes off a
/// mode far above the rest would pass through f_0 and be too long a step for it; such modes come first and have a
/// second column each, with what the first one lost.
template <class T>
struct DeflatedStep {
  struct Part {
    std::size_t order = 0;
    std::size_t rank = 0;                    ///< a multiple of vector_group
    std::size_t refined = 0;                 ///< how many have a second column; a multiple of vector_group, <= rank
    const std::uint16_t* vectors = nullptr;  ///< order x columns(), row-major: first columns, then second ones
    const T* gains = nullptr;                ///< levels x rank, f_k - f_0; nought where there is no mode
    const T* rest = nullptr;                 ///< levels of them, f_0
    const std::int32_t* index = nullptr;     ///< rows of A: a row's place in the class, -1 for none; null: its own
    const T* share = nullptr;                ///< rows of A: entry of the class's unit vector at a row

    [[nodiscard]] std::size_t columns() const noexcept { return rank + refined; }
  };

  static constexpr std::size_t vector_group = 16;

  std::size_t order = 0;  ///< rows of A
  std::size_t classes = 0;
  std::size_t levels = 1;  ///< of tau, as in a PenaltySchedule
  /// Where every row has three mirror images: the rows of A of each place of the classes, four a place, so that class c
  /// takes half the row of image g with the sign of (-1)^(number of bits that c and g share). Else null.
  const std::int32_t* images = nullptr;
  Part parts[4];
  Crew crew = {};  ///< shares classes where every row has three mirror images

  /// Elements of T that apply() and restrict_to() want as scratch.
  [[nodiscard]] std::size_t scratch_size() const noexcept {
    std::size_t most = 0;
    for (std::size_t c = 0; c < classes; ++c) most = parts[c].columns() > most ? parts[c].columns() : most;
    return order + (images != nullptr ? classes : 1) * most;
  }
};

/// y = F x with the tau of `level`. x and y may not overlap.
void apply(const DeflatedStep<float>& f, std::size_t level, const float* x, float* y, float* scratch) noexcept;
void apply(const DeflatedStep<double>& f, std::size_t level, const double* x, double* y, double* scratch) noexcept;

/// The lower triangle of the first level's F's rows and columns `index`, `count` of them, row-major count x count.
void restrict_to(const DeflatedStep<float>& f, const std::size_t* index, std::size_t count, double* out,
                 float* scratch) noexcept;
void restrict_to(const DeflatedStep<double>& f, const std::size_t* index, std::size_t count, double* out,
                 double* scratch) noexcept;

/// sqrt(f_0 - f_k) U of a row of the only class, at the first level: rank values.
void read_modes(const DeflatedStep<float>::Part& part, std::size_t row, double* out) noexcept;
void read_modes(const DeflatedStep<double>::Part& part, std::size_t row, double* out) noexcept;

}  // namespace compueye::recon::core
