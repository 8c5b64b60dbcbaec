#include "recon/setup/gram_matrix.hpp"

#include <algorithm>
#include <cmath>

#include "recon/core/parts/vector_sums.hpp"
#include "recon/setup/basis_tables.hpp"
#include "recon/setup/on_all_cores.hpp"
#include "recon/setup/operator_list.hpp"
#include "recon/setup/rounded_form.hpp"

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
  // Of few entries a product by runs is as quick as its tables are made.
  if (response.rounded_for() == OperatorKind::wavelet_runs && response.nonzeros() >= streamed_entries) {
    wavelets_ = wavelet_run_tables<double>(response);
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
  if (wavelets_) scratch.sums.resize(wavelets_->view.scratch_size(1));
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
  if (wavelets_) return core::forward(wavelets_->view, picture.data(), out.data(), scratch.sums.data());
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

ParityGram::ParityGram(const Response& seeing, MetricKind metric)
    : gram_(seeing, metric), classes_(seeing.rows(), find_mirror_symmetry(seeing)) {
  for (std::size_t c = 0; c < classes_.count(); ++c) blocks_.emplace_back(classes_.order(c), classes_.order(c));
}

hal::Result<void> ParityGram::fill(const Progress& progress) {
  const auto& orbits = classes_.orbits();
  const bool made = on_all_cores(static_cast<int>(orbits.size()), "A A'", progress, [&, this] {
    return [&, this, scratch = gram_.make_scratch(),
            row = std::vector<double>(static_cast<std::size_t>(gram_.order()))](int orbit) mutable {
      gram_.row(orbits[static_cast<std::size_t>(orbit)].first, scratch, row);
      fill_row(orbit, row);
    };
  });
  if (made) return {};
  return hal::fail(hal::ErrorCode::interrupted, "set-up", "stopped before A A' was finished");
}

/// Between unit vectors of two orbits p, q in class c: (|G| / (norm_p norm_q)) sum_g c(g) (A A')(p, g q).
void ParityGram::fill_row(int p, const std::vector<double>& row) {
  const MirrorSymmetry& symmetry = classes_.symmetry();
  const auto& orbits = classes_.orbits();
  const double group = static_cast<double>(symmetry.order());
  for (std::size_t c = 0; c < classes_.count(); ++c) {
    const int at = classes_.position(c, p);
    if (at < 0) continue;
    const double stabiliser_p = orbits[static_cast<std::size_t>(p)].stabiliser;
    for (std::size_t q = 0; q < orbits.size(); ++q) {
      const int to = classes_.position(c, static_cast<int>(q));
      if (to < 0) continue;
      double sum = 0.0;
      for (std::size_t g = 0; g < symmetry.order(); ++g) {
        const auto image = symmetry.permutations[g][static_cast<std::size_t>(orbits[q].first)];
        sum += symmetry.characters[c][g] * row[static_cast<std::size_t>(image)];
      }
      const double norms = std::sqrt(stabiliser_p * group) * std::sqrt(orbits[q].stabiliser * group);
      blocks_[c](to, at) = sum * group / norms;
    }
  }
}

}  // namespace compueye::recon
