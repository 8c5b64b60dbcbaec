#include "recon/setup/gram_matrix.hpp"

#include <algorithm>

#include "recon/core/parts/vector_sums.hpp"
#include "recon/setup/dct_tables.hpp"
#include "recon/setup/operator_choice.hpp"
#include "recon/setup/smoothing.hpp"

namespace compueye::recon {
namespace {

bool sums(OperatorKind kind) {
  return kind == OperatorKind::running_sums || kind == OperatorKind::running_sums_symmetric ||
         kind == OperatorKind::running_sums_diagonal;
}

}  // namespace

GramMatrix::GramMatrix(const Response& response, MetricKind metric) : response_(response) {
  if (const auto chosen = choose_operator(response, std::nullopt); chosen && sums(chosen->kind)) {
    sums_ = running_sum_tables<double>(response, chosen->images, chosen->transposed);
  }
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
  if (metric == MetricKind::identity) return;
  row_table_ = make_dct_table<double>(response.image_rows());
  col_table_ = make_dct_table<double>(response.image_cols());
  for (const double eigenvalue : smoothing_eigenvalues(response.image_rows(), response.image_cols())) {
    inverse_eigenvalues_.push_back(1.0 / eigenvalue);
  }
  metric_ = {inverse_eigenvalues_.data(),
             {{static_cast<std::size_t>(response.image_rows()), row_table_.data()},
              {static_cast<std::size_t>(response.image_cols()), col_table_.data()}}};
}

GramMatrix::Scratch GramMatrix::make_scratch() const {
  const auto pixels = static_cast<std::size_t>(response_.cols());
  Scratch scratch{std::vector<double>(pixels, 0.0), {}, {}, {}};
  if (sums_) scratch.sums.resize(sums_->view.scratch_size());
  if (!metric_.is_identity()) {
    scratch.coefficients.resize(pixels);
    scratch.strips.resize(core::dct_scratch_size(metric_.dct.rows.length, metric_.dct.cols.length));
  }
  return scratch;
}

void GramMatrix::row(int i, Scratch& scratch, std::span<double> out) const {
  std::vector<double>& picture = scratch.picture;
  response_.for_each_in_row(i, [&](std::int32_t n, double v) { picture[static_cast<std::size_t>(n)] = v; });
  core::apply_inverse(metric_, picture.data(), scratch.coefficients.data(), scratch.strips.data());
  apply_to(picture, scratch, out);
  if (metric_.is_identity()) {
    response_.for_each_in_row(i, [&](std::int32_t n, double) { picture[static_cast<std::size_t>(n)] = 0.0; });
  } else {
    std::fill(picture.begin(), picture.end(), 0.0);
  }
}

void GramMatrix::apply_to(const std::vector<double>& picture, Scratch& scratch, std::span<double> out) const {
  if (sums_) return core::forward(sums_->view, picture.data(), out.data(), scratch.sums.data());
  const double* values = response_.values().data();
  for (std::size_t j = 0; j < out.size(); ++j) {
    double sum = 0.0;
    for (std::size_t r = first_run_[j]; r < first_run_[j + 1]; ++r) {
      sum += core::dot(values + runs_[r].entry, picture.data() + runs_[r].column,
                       static_cast<std::size_t>(runs_[r].length));
    }
    out[j] = sum;
  }
}

}  // namespace compueye::recon
