#pragma once

#include <span>
#include <string_view>

#include "recon/reconstructor.hpp"

namespace compueye::firmware {

/// A word of board.toml and of the command line, and what it stands for.
template <class Kind>
struct Named {
  std::string_view name;
  Kind kind;
};

[[nodiscard]] std::span<const Named<recon::SolverKind>> solver_names() noexcept;
[[nodiscard]] std::span<const Named<recon::BasisKind>> basis_names() noexcept;
[[nodiscard]] std::span<const Named<recon::ConstraintKind>> constraint_names() noexcept;

[[nodiscard]] std::string_view name(recon::SolverKind kind) noexcept;
[[nodiscard]] std::string_view name(recon::BasisKind kind) noexcept;
[[nodiscard]] std::string_view name(recon::ConstraintKind kind) noexcept;

}  // namespace compueye::firmware
