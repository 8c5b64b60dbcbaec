#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "recon/core/bases/basis.hpp"
#include "recon/problem/response.hpp"
#include "recon/setup/factor.hpp"
#include "recon/setup/mirror_symmetry.hpp"
#include "recon/setup/running_sum_tables.hpp"
#include "recon/setup/wavelet_run_tables.hpp"

namespace compueye::recon {

/// Entries of A K0^-1 A' in double, a row at a time: A applied to one of its own rows, as running sums where fields are
/// drawn (a twentieth of the work), as wavelet runs where they were rounded to those; else run by run, because even a
/// measured field is a few runs of neighbouring pixels.
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
  std::optional<WaveletRunTables<double>> wavelets_;
  std::vector<Run> runs_;
  std::vector<std::size_t> first_run_;  // M + 1
  std::vector<double> row_table_;
  std::vector<double> col_table_;
  std::vector<double> inverse_eigenvalues_;
  core::Metric<double> metric_;
};

/// A K0^-1 A' of the seeing rows, one block a parity class, so that everything that is cubic in the order costs a
/// sixteenth where the eye is mirror symmetric. In double.
class ParityGram {
 public:
  /// `seeing` has no blind rows and outlives this.
  ParityGram(const Response& seeing, MetricKind metric);

  /// Computes all blocks. Error: interrupted.
  [[nodiscard]] hal::Result<void> fill(const Progress& progress);

  [[nodiscard]] const GramMatrix& matrix() const noexcept { return gram_; }
  [[nodiscard]] const ParityClasses& classes() const noexcept { return classes_; }
  [[nodiscard]] Eigen::MatrixXd& block(std::size_t c) noexcept { return blocks_[c]; }
  [[nodiscard]] const Eigen::MatrixXd& block(std::size_t c) const noexcept { return blocks_[c]; }

 private:
  void fill_row(int p, const std::vector<double>& row);  // of the first row of orbit p

  GramMatrix gram_;
  ParityClasses classes_;
  std::vector<Eigen::MatrixXd> blocks_;
};

}  // namespace compueye::recon
