#pragma once

#include <cstddef>
#include <cstdint>

#include "recon/core/bases/dct.hpp"
#include "recon/core/bases/fourier.hpp"

namespace compueye::recon {

enum class BasisKind : std::uint8_t { identity, dct, haar, db4, dft, tv };

}  // namespace compueye::recon

namespace compueye::recon::core {

/// Psi of the objective's ||Psi x||_1, as a view of tables that somebody else owns. Orthonormal for every kind but tv,
/// whose Psi are forward differences (core/differences.hpp).
template <class T>
struct Basis {
  BasisKind kind = BasisKind::identity;
  std::size_t rows = 0;
  std::size_t cols = 0;
  Dct2d<T> dct;          ///< for dct, and for tv, whose D'D it diagonalises
  Fourier2d<T> fourier;  ///< for dft

  [[nodiscard]] std::size_t pixels() const noexcept { return rows * cols; }
  [[nodiscard]] std::size_t coefficients() const noexcept { return kind == BasisKind::tv ? 2 * pixels() : pixels(); }
  [[nodiscard]] bool orthonormal() const noexcept { return kind != BasisKind::tv; }
  /// ||Psi||_2^2 is at most this.
  [[nodiscard]] double squared_norm() const noexcept { return kind == BasisKind::tv ? 8.0 : 1.0; }
  /// Elements of T that analyse() and synthesise() want as scratch.
  [[nodiscard]] std::size_t scratch_size() const noexcept;

  /// Its numbers and tables, see core/frame/frozen_layout.hpp.
  template <class Archive>
  void fields(Archive& archive) {
    archive.kind(kind);
    archive.number(rows);
    archive.number(cols);
    describe(dct, archive);
    archive.number(fourier.rows);
    archive.number(fourier.cols);
    archive.table(fourier.row_table, fourier.rows * fourier.rows);
    archive.table(fourier.col_table, fourier.cols * fourier.cols);
  }
};

/// c = Psi x. x and c may not overlap.
void analyse(const Basis<float>& psi, const float* x, float* c, float* scratch) noexcept;
void analyse(const Basis<double>& psi, const double* x, double* c, double* scratch) noexcept;

/// x = Psi' c. x and c may not overlap.
void synthesise(const Basis<float>& psi, const float* c, float* x, float* scratch) noexcept;
void synthesise(const Basis<double>& psi, const double* c, double* x, double* scratch) noexcept;

extern template struct Basis<float>;
extern template struct Basis<double>;

/// K0 of the quadratic step rho/2 (x - v)' K0 (x - v). The identity for an orthonormal basis; D'D + I for total
/// variation, whose inverse is diagonal in the 2-D DCT.
template <class T>
struct Metric {
  const T* inverse_eigenvalues = nullptr;  ///< one a DCT coefficient; null: K0 = I
  Dct2d<T> dct;

  [[nodiscard]] bool is_identity() const noexcept { return inverse_eigenvalues == nullptr; }
};

/// x becomes K0^-1 x; `coefficients` takes a picture, `scratch` what the DCT wants.
template <class T>
void apply_inverse(const Metric<T>& metric, T* x, T* coefficients, T* scratch) noexcept;

}  // namespace compueye::recon::core
