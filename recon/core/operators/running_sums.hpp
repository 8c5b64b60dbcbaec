#pragma once

#include <cstddef>
#include <cstdint>

#include "recon/core/parts/crew.hpp"

namespace compueye::recon::core {

/// A = D S for receptive fields that are one run of coverages on every pixel row. S are running sums along each half
/// pixel row, outward from the picture's centre line; D holds the differences of consecutive coverages, which vanish
/// but near the ends of a run: about an eighth of A's entries. (Summation by parts; the same idea as the integral image
/// of Crow 1984, in one dimension.)
///
/// The picture's four quadrants lie in the four lanes of a vector, folded on the centre lines: element (r, c) of lane l
/// is r rows below the centre line (l & 2) or above it, c columns right of it (l & 1) or left. Where A is mirror
/// symmetric on both axes a row and its images share one table and are computed at once, flips being permutations of
/// lanes; else every row has a table of its own. Where A is symmetric on the diagonal as well, four more lanes hold the
/// transposed picture, folded in the same way, and eight rows share a table.
///
/// Taps ascend in element, and so by folded row: bands of those rows cut them into pieces that the adjoint can add
/// independently of each other.
template <class T>
struct RunningSums {
  std::size_t rows_at_once = 1;  ///< 1, 4 or 8
  std::size_t image_rows = 0;    ///< both even where 4, even and equal where 8
  std::size_t image_cols = 0;
  std::size_t tables = 0;  ///< rows of A, or orbits of up to four or eight of them
  std::size_t bands = 1;
  /// 4 tables * bands + 1: taps of table t in lane q and band k are first[(4t+q)*bands+k] .. the next one less 1.
  const std::uint32_t* first = nullptr;
  const std::uint16_t* element = nullptr;  ///< r * half_cols + c of each tap
  const T* difference = nullptr;           ///< coverage at that element less coverage one further out
  const std::int32_t* row = nullptr;       ///< rows_at_once tables: the row of A in each lane, -1 for one already there
  const std::uint32_t* band_row = nullptr;  ///< bands + 1: the first folded row of each, then half_rows()

  [[nodiscard]] std::size_t half_rows() const noexcept { return (image_rows + 1) / 2; }
  [[nodiscard]] std::size_t half_cols() const noexcept { return (image_cols + 1) / 2; }
  /// Elements of T that forward() and adjoint() want as scratch, aligned to 64 bytes.
  [[nodiscard]] std::size_t scratch_size() const noexcept {
    return (rows_at_once == 8 ? 8 : 4) * half_rows() * half_cols();
  }
  /// The same where several workers share the work. Mirrored rows of A lie all over y, and two cores that write to the
  /// same cache lines spend their time on them: products wait here in the order of the tables.
  [[nodiscard]] std::size_t shared_scratch_size() const noexcept {
    return scratch_size() + (rows_at_once > 1 ? rows_at_once * tables : 0);
  }
};

/// Bytes of tables that one application reads, and its multiply-adds and additions.
std::size_t bytes(const RunningSums<float>& a) noexcept;
std::size_t bytes(const RunningSums<double>& a) noexcept;
std::size_t flops(const RunningSums<float>& a) noexcept;
std::size_t flops(const RunningSums<double>& a) noexcept;

/// y = A x. Workers share folded rows, then tables; `scratch` is then shared_scratch_size().
void forward(const RunningSums<float>& a, const float* x, float* y, float* scratch, const Crew& crew = {}) noexcept;
void forward(const RunningSums<double>& a, const double* x, double* y, double* scratch, const Crew& crew = {}) noexcept;

/// x += A' y. Workers share bands, then folded rows.
void adjoint_accumulate(const RunningSums<float>& a, const float* y, float* x, float* scratch,
                        const Crew& crew = {}) noexcept;
void adjoint_accumulate(const RunningSums<double>& a, const double* y, double* x, double* scratch,
                        const Crew& crew = {}) noexcept;

}  // namespace compueye::recon::core
