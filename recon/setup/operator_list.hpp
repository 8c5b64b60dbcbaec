#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

#include "hal/result.hpp"
#include "recon/core/operators/linear_operator.hpp"
#include "recon/response.hpp"
#include "recon/setup/kept_tables.hpp"

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

}  // namespace compueye::recon
