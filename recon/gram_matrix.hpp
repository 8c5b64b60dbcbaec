#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "recon/response.hpp"

namespace compueye::recon {

/// Entries of A A' in double, a row at a time. Receptive fields are convex, so a sparse row is a few runs of
/// neighbouring pixels: products go run by run.
class GramMatrix {
 public:
  explicit GramMatrix(const Response& response);

  /// out[j] = sum_n a_in a_jn for all j; `scratch` has cols() zeros and is left so. Safe from several threads, each
  /// with its own scratch.
  void row(int i, std::span<double> scratch, std::span<double> out) const;

  [[nodiscard]] int order() const noexcept { return response_.rows(); }
  [[nodiscard]] int cols() const noexcept { return response_.cols(); }

 private:
  struct Run {
    std::int32_t column = 0;
    std::int32_t length = 0;
    std::int64_t entry = 0;
  };

  const Response& response_;
  std::vector<Run> runs_;
  std::vector<std::size_t> first_run_;  // M + 1
};

}  // namespace compueye::recon
