#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "recon/core/frame/metric.hpp"
#include "recon/response.hpp"
#include "recon/setup/factor.hpp"
#include "recon/setup/running_sum_tables.hpp"

namespace compueye::recon {

/// Entries of A K0^-1 A' in double, a row at a time: A applied to one of its own rows, as running sums where fields are
/// drawn (a twentieth of the work); else run by run, because even a measured field is a few runs of neighbouring
/// pixels.
class GramMatrix {
 public:
  GramMatrix(const GramMatrix&) = delete;
  GramMatrix& operator=(const GramMatrix&) = delete;
  ~GramMatrix() = default;
  GramMatrix(const Response& response, MetricKind metric);

  /// What row() works in, one a thread.
  struct Scratch {
    std::vector<double> picture;  // all zero between calls
    std::vector<double> coefficients;
    std::vector<double> strips;
    std::vector<double> sums;
  };
  [[nodiscard]] Scratch make_scratch() const;

  /// out[j] = entry (i, j) for all j. Safe from several threads, each with its own scratch.
  void row(int i, Scratch& scratch, std::span<double> out) const;

  [[nodiscard]] int order() const noexcept { return response_.rows(); }
  [[nodiscard]] int cols() const noexcept { return response_.cols(); }

 private:
  struct Run {
    std::int32_t column = 0;
    std::int32_t length = 0;
    std::int64_t entry = 0;
  };

  void apply_to(const std::vector<double>& picture, Scratch& scratch, std::span<double> out) const;

  const Response& response_;
  std::optional<RunningSumTables<double>> sums_;
  std::vector<Run> runs_;
  std::vector<std::size_t> first_run_;  // M + 1
  std::vector<double> row_table_;
  std::vector<double> col_table_;
  std::vector<double> inverse_eigenvalues_;
  core::Metric<double> metric_;
};

}  // namespace compueye::recon
