#pragma once

#include <span>
#include <string_view>

#include "recon/reconstructor.hpp"

namespace compueye::recon {

/// A word of board.toml and of the command line, and what it stands for.
template <class Kind>
struct Named {
  std::string_view name;
  Kind kind;
};

/// Without adm as published, which is no solver to choose but one to be shown beside the others.
[[nodiscard]] std::span<const Named<SolverKind>> solver_names() noexcept;
[[nodiscard]] std::span<const Named<BasisKind>> basis_names() noexcept;
[[nodiscard]] std::span<const Named<ConstraintKind>> constraint_names() noexcept;
/// What Plan::op may be: running-sums stands for every one of them.
[[nodiscard]] std::span<const Named<OperatorKind>> operator_names() noexcept;

[[nodiscard]] std::string_view name(SolverKind kind) noexcept;
[[nodiscard]] std::string_view name(BasisKind kind) noexcept;
[[nodiscard]] std::string_view name(ConstraintKind kind) noexcept;
[[nodiscard]] std::string_view name(OperatorKind kind) noexcept;

}  // namespace compueye::recon
