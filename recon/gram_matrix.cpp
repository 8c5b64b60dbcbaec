#include "recon/gram_matrix.hpp"

#include "recon/core/vector_sums.hpp"

namespace compueye::recon {

GramMatrix::GramMatrix(const Response& response) : response_(response) {
  std::int64_t entry = 0;
  for (int m = 0; m < response.rows(); ++m) {
    first_run_.push_back(runs_.size());
    response.for_each_in_row(m, [&](std::int32_t column, double) {
      const bool continues = runs_.size() > first_run_.back() && runs_.back().column + runs_.back().length == column;
      if (continues) {
        ++runs_.back().length;
      } else {
        runs_.push_back({column, 1, entry});
      }
      ++entry;
    });
  }
  first_run_.push_back(runs_.size());
}

void GramMatrix::row(int i, std::span<double> scratch, std::span<double> out) const {
  response_.for_each_in_row(i, [&](std::int32_t n, double v) { scratch[static_cast<std::size_t>(n)] = v; });
  const double* values = response_.values().data();
  for (std::size_t j = 0; j < out.size(); ++j) {
    double sum = 0.0;
    for (std::size_t r = first_run_[j]; r < first_run_[j + 1]; ++r) {
      sum += core::dot(values + runs_[r].entry, scratch.data() + runs_[r].column,
                       static_cast<std::size_t>(runs_[r].length));
    }
    out[j] = sum;
  }
  response_.for_each_in_row(i, [&](std::int32_t n, double) { scratch[static_cast<std::size_t>(n)] = 0.0; });
}

}  // namespace compueye::recon
