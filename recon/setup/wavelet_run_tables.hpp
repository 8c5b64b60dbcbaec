#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "recon/core/operators/wavelet_runs.hpp"
#include "recon/problem/response.hpp"

namespace compueye::recon {

/// The tables that core::WaveletRuns looks at.
template <class T>
struct WaveletRunTables {
  struct Tiles {
    std::vector<std::uint32_t> first;
    std::vector<std::uint16_t> place;
    std::vector<std::uint32_t> words;

    [[nodiscard]] std::size_t bytes() const noexcept {
      return (first.size() + words.size()) * sizeof(std::uint32_t) + place.size() * sizeof(std::uint16_t);
    }
  };

  Tiles averages, details;
  std::vector<T> scale;
  std::vector<std::int32_t> row;
  std::vector<std::uint32_t> band;
  core::WaveletRuns<T> view;

  [[nodiscard]] std::size_t bytes() const noexcept {
    return averages.bytes() + details.bytes() + scale.size() * sizeof(T) + row.size() * sizeof(std::int32_t) +
           band.size() * sizeof(std::uint32_t);
  }
};

/// Of rows that rounded_in_wavelets() made of a response that wavelets_fit().
template <class T>
[[nodiscard]] WaveletRunTables<T> wavelet_run_tables(const Response& seeing);

}  // namespace compueye::recon
