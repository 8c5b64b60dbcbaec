#pragma once

#include <span>
#include <string_view>

#include "recon/core/bases/basis.hpp"
#include "recon/setup/kept_tables.hpp"

namespace compueye::recon {

/// A basis: its word on boards and command lines, and the tables of its view (kind, rows and cols are filled in).
struct BasisRow {
  std::string_view name;
  BasisKind kind;
  void (*tables_f32)(core::Basis<float>& psi, KeptTables& kept) = nullptr;  ///< null: it has none
  void (*tables_f64)(core::Basis<double>& psi, KeptTables& kept) = nullptr;
};

/// Every basis, in the order in which they are shown.
[[nodiscard]] std::span<const BasisRow> bases() noexcept;

template <class T>
[[nodiscard]] core::Basis<T> make_basis(BasisKind kind, int image_rows, int image_cols, KeptTables& kept);

/// K0 that goes with a basis: the identity, or D'D + I of total variation.
template <class T>
[[nodiscard]] core::Metric<T> make_metric(const core::Basis<T>& psi, KeptTables& kept);

}  // namespace compueye::recon
