#pragma once

#include <cstddef>
#include <cstdint>

#include "recon/core/parts/crew.hpp"

namespace compueye::recon::core {

/// How the entries of DenseRuns are held: as T, as bfloat16 (a float's upper half) or as whole numbers -127 .. 127
/// times a scale of their row.
enum class RunValues : std::uint8_t { full, bf16, int8 };

/// A for rows that are runs of any values, one or more on every pixel row: what a calibration measures. Four rows make
/// a block and share its runs, so that a pixel is read (and, in the adjoint, written) once for four rows. A run is
/// whole groups of 16 pixels, anywhere within the picture; where a row sees less of it than the others, or a run is
/// shorter than its groups, values are zero. A pixel that is not finite may therefore spoil rows that do not see it.
///
/// The picture is cut into bands of pixels that no group crosses, so that each band of A' y can be computed by itself.
///
/// Of group g, full: values[64 g + 16 l + k] is row l at pixel k. bf16: words[32 g + 16 h + k] holds row 2h in its
/// lower half, row 2h+1 in its upper. int8: byte l of words[16 g + k], counted from the lowest, is row l.
template <class T>
struct DenseRuns {
  static constexpr std::size_t rows_at_once = 4;
  static constexpr std::size_t group_pixels = 16;

  RunValues stored = RunValues::full;
  std::size_t blocks = 0;
  std::size_t bands = 1;
  const std::uint32_t* first = nullptr;   ///< blocks * bands + 1: runs of block b in band k are first[b*bands+k] ..
  const std::uint32_t* group = nullptr;   ///< blocks * bands + 1: likewise the groups, all runs' in one row
  const std::uint32_t* start = nullptr;   ///< of each run, its first pixel
  const std::uint16_t* groups = nullptr;  ///< of each run, how many
  const std::int32_t* row = nullptr;      ///< 4 blocks: the row of A, -1 where the last block has none
  const T* values = nullptr;              ///< full
  const std::uint32_t* words = nullptr;   ///< bf16, int8
  const T* scale = nullptr;               ///< int8: 4 blocks
};

/// Bytes of tables that one application reads, and its multiply-adds, those with filled up zeros among them.
std::size_t bytes(const DenseRuns<float>& a) noexcept;
std::size_t bytes(const DenseRuns<double>& a) noexcept;
std::size_t flops(const DenseRuns<float>& a) noexcept;
std::size_t flops(const DenseRuns<double>& a) noexcept;

/// y = A x. Entry k of a group goes to lane k of 16, runs ascending; lanes are added as in core/vector_sums.hpp.
void forward(const DenseRuns<float>& a, const float* x, float* y, const Crew& crew = {}) noexcept;
void forward(const DenseRuns<double>& a, const double* x, double* y, const Crew& crew = {}) noexcept;

/// x += A' y, rows ascending. Workers share blocks in the one and bands in the other.
void adjoint_accumulate(const DenseRuns<float>& a, const float* y, float* x, const Crew& crew = {}) noexcept;
void adjoint_accumulate(const DenseRuns<double>& a, const double* y, double* x, const Crew& crew = {}) noexcept;

}  // namespace compueye::recon::core
