#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "recon/core/operators/running_sums.hpp"
#include "recon/problem/response.hpp"
#include "recon/setup/mirror_symmetry.hpp"

namespace compueye::recon {

/// The tables that core::RunningSums looks at.
template <class T>
struct RunningSumTables {
  std::vector<std::uint32_t> first;
  std::vector<std::uint16_t> element;
  std::vector<T> difference;
  std::vector<std::int32_t> row;
  std::vector<std::uint32_t> band_row;
  core::RunningSums<T> view;

  [[nodiscard]] std::size_t bytes() const noexcept {
    return (first.size() + band_row.size()) * sizeof(std::uint32_t) + element.size() * sizeof(std::uint16_t) +
           difference.size() * sizeof(T) + row.size() * sizeof(std::int32_t);
  }
};

/// Whether the picture is known, and 16 bits can number the pixels of a quadrant.
[[nodiscard]] bool running_sums_fit(int image_rows, int image_cols) noexcept;

/// How many rows can share a table: 8 where `symmetry` has all four images, `transposed` is what
/// find_diagonal_symmetry() found and the picture's sides are even and equal, 4 without the last two, else 1.
[[nodiscard]] int rows_sharing_tables(int image_rows, int image_cols, const MirrorSymmetry& symmetry,
                                      const std::vector<std::int32_t>& transposed) noexcept;

/// A response as running sums, with as many rows a table as rows_sharing_tables() says. Differences below the rounding
/// of T, relative to the largest entry, are left out. Nothing unless running_sums_fit().
template <class T>
[[nodiscard]] std::optional<RunningSumTables<T>> running_sum_tables(const Response& seeing,
                                                                    const MirrorSymmetry& symmetry,
                                                                    const std::vector<std::int32_t>& transposed = {});

/// How many differences of `seeing` are not negligible: what one of its rows after the other would take as running
/// sums, to be compared with its entries.
[[nodiscard]] std::int64_t running_sum_taps(const Response& seeing);

}  // namespace compueye::recon
