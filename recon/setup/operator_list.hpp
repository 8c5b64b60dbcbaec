#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "hal/result.hpp"
#include "recon/core/operators/linear_operator.hpp"
#include "recon/problem/response.hpp"
#include "recon/setup/kept_tables.hpp"
#include "recon/setup/mirror_symmetry.hpp"

namespace compueye::recon {

/// A form of A: what it is called in sentences and results, and the word that asks for it on boards and command lines;
/// empty where another row's word stands for it (running-sums for every number of rows at once).
struct OperatorRow {
  std::string_view name;
  std::string_view word;
  OperatorKind kind;
  bool lossy = false;  ///< keeps fewer digits than the precision of the frame path
};

/// Every form of A, in the order in which they are shown.
[[nodiscard]] std::span<const OperatorRow> operators() noexcept;

[[nodiscard]] bool is_lossy(OperatorKind kind) noexcept;

/// A of the seeing rows in the form that choose_operator() finds, whose errors it has. For a lossy one `seeing` must be
/// what quantised() makes of the response.
template <class T>
[[nodiscard]] hal::Result<core::LinearOperator<T>> make_operator(const Response& seeing,
                                                                 std::optional<OperatorKind> asked, KeptTables& kept);

/// What applying A in float32 takes; A' takes the same.
struct OperatorFigures {
  OperatorKind kind = OperatorKind::csr;
  std::size_t bytes = 0;  ///< of tables
  std::size_t flops = 0;  ///< multiply-adds, the additions of running sums among them
};

/// Of the seeing rows, in the form that Plan::op asks for. Errors: those of choose_operator().
[[nodiscard]] hal::Result<OperatorFigures> operator_figures(const Response& response,
                                                            std::optional<OperatorKind> asked);

/// The form in which A is applied, and the mirror images that running sums are to use.
struct OperatorChoice {
  OperatorKind kind = OperatorKind::csr;
  MirrorSymmetry images;
  std::vector<std::int32_t> transposed;  ///< of find_diagonal_symmetry()
};

/// The quickest form for a response, by the number of entries, differences and run values: running sums where rows are
/// flat runs, dense runs where they are other runs, else dense or sparse. Never a lossy one
/// (recon/setup/rounded_form.hpp). `asked` sets the form: error unsupported, saying which would do, when running sums
/// have no fewer differences than there are entries, the picture is too small for a run or too large for running sums,
/// or sparse entries outnumber 32 bits.
[[nodiscard]] hal::Result<OperatorChoice> choose_operator(const Response& seeing, std::optional<OperatorKind> asked);

}  // namespace compueye::recon
