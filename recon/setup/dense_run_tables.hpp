#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "recon/core/operators/dense_runs.hpp"
#include "recon/problem/response.hpp"

namespace compueye::recon {

/// The tables that core::DenseRuns looks at.
template <class T>
struct DenseRunTables {
  std::vector<std::uint32_t> first;
  std::vector<std::uint32_t> group;
  std::vector<std::uint32_t> start;
  std::vector<std::uint16_t> groups;
  std::vector<std::int32_t> row;
  std::vector<T> values;
  std::vector<std::uint32_t> words;
  std::vector<T> scale;
  core::DenseRuns<T> view;

  [[nodiscard]] std::size_t bytes() const noexcept {
    return (first.size() + group.size() + start.size() + words.size()) * sizeof(std::uint32_t) +
           groups.size() * sizeof(std::uint16_t) + row.size() * sizeof(std::int32_t) +
           (values.size() + scale.size()) * sizeof(T);
  }
};

/// A picture that can be held as dense runs has at least one group of pixels.
inline constexpr int least_run_pixels = 16;

/// A response as dense runs; for bf16 and int8 it must be what quantised() makes of one. Nothing for a picture of fewer
/// than least_run_pixels pixels.
template <class T>
[[nodiscard]] std::optional<DenseRunTables<T>> dense_run_tables(const Response& seeing, core::RunValues stored);

/// How many values the runs hold, zeros that fill them up included: to be compared with other forms.
[[nodiscard]] std::int64_t dense_run_values(const Response& seeing);

}  // namespace compueye::recon
