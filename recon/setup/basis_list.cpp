#include "recon/setup/basis_list.hpp"

#include <array>
#include <type_traits>
#include <utility>
#include <vector>

#include "recon/setup/basis_tables.hpp"

namespace compueye::recon {
namespace {

template <class T>
void dct_tables(core::Basis<T>& psi, KeptTables& kept) {
  psi.dct = {{psi.rows, kept.keep(make_dct_table<T>(static_cast<int>(psi.rows)))},
             {psi.cols, kept.keep(make_dct_table<T>(static_cast<int>(psi.cols)))}};
}

template <class T>
void fourier_tables(core::Basis<T>& psi, KeptTables& kept) {
  psi.fourier = {psi.rows, psi.cols, kept.keep(make_fourier_table<T>(static_cast<int>(psi.rows))),
                 kept.keep(make_fourier_table<T>(static_cast<int>(psi.cols)))};
}

constexpr std::array<BasisRow, 6> rows{{
    {"identity", BasisKind::identity},
    {"dct", BasisKind::dct, dct_tables<float>, dct_tables<double>},
    {"haar", BasisKind::haar},
    {"db4", BasisKind::db4},
    {"dft", BasisKind::dft, fourier_tables<float>, fourier_tables<double>},
    {"tv", BasisKind::tv, dct_tables<float>, dct_tables<double>},
}};

}  // namespace

std::span<const BasisRow> bases() noexcept {
  return rows;
}

template <class T>
core::Basis<T> make_basis(BasisKind kind, int image_rows, int image_cols, KeptTables& kept) {
  core::Basis<T> psi;
  psi.kind = kind;
  psi.rows = static_cast<std::size_t>(image_rows);
  psi.cols = static_cast<std::size_t>(image_cols);
  for (const BasisRow& row : rows) {
    if (row.kind != kind || row.tables_f32 == nullptr) continue;
    if constexpr (std::is_same_v<T, float>) {
      row.tables_f32(psi, kept);
    } else {
      row.tables_f64(psi, kept);
    }
  }
  return psi;
}

template <class T>
core::Metric<T> make_metric(const core::Basis<T>& psi, KeptTables& kept) {
  if (psi.kind != BasisKind::tv) return {};
  std::vector<T> inverses;
  for (const double eigenvalue : smoothing_eigenvalues(static_cast<int>(psi.rows), static_cast<int>(psi.cols))) {
    inverses.push_back(static_cast<T>(1.0 / eigenvalue));
  }
  return {kept.keep(std::move(inverses)), psi.dct};
}

template core::Basis<float> make_basis(BasisKind, int, int, KeptTables&);
template core::Basis<double> make_basis(BasisKind, int, int, KeptTables&);
template core::Metric<float> make_metric(const core::Basis<float>&, KeptTables&);
template core::Metric<double> make_metric(const core::Basis<double>&, KeptTables&);

}  // namespace compueye::recon
