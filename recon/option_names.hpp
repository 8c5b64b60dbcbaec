#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "recon/problem/plan.hpp"

namespace compueye::recon {

/// A word of board.toml and of the command line, and what it stands for.
template <class Kind>
struct Named {
  std::string_view name;
  Kind kind;
};

/// The words of a table, in its order.
template <class Kind>
[[nodiscard]] std::vector<std::string_view> words_of(std::span<const Named<Kind>> table) {
  std::vector<std::string_view> words;
  for (const Named<Kind>& named : table) words.push_back(named.name);
  return words;
}

/// What a word of the table stands for; nothing for any other.
template <class Kind>
[[nodiscard]] std::optional<Kind> kind_of(std::span<const Named<Kind>> table, std::string_view word) noexcept {
  for (const Named<Kind>& named : table) {
    if (named.name == word) return named.kind;
  }
  return std::nullopt;
}

/// Without those that are only shown beside the others.
[[nodiscard]] std::span<const Named<SolverKind>> solver_names() noexcept;
[[nodiscard]] std::span<const Named<BasisKind>> basis_names() noexcept;
[[nodiscard]] std::span<const Named<ConstraintKind>> constraint_names() noexcept;
[[nodiscard]] std::span<const Named<Precision>> precision_names() noexcept;
/// What Plan::op may be: running-sums stands for every one of them.
[[nodiscard]] std::span<const Named<OperatorKind>> operator_names() noexcept;

[[nodiscard]] std::string_view name(SolverKind kind) noexcept;
[[nodiscard]] std::string_view name(BasisKind kind) noexcept;
[[nodiscard]] std::string_view name(ConstraintKind kind) noexcept;
[[nodiscard]] std::string_view name(OperatorKind kind) noexcept;
[[nodiscard]] std::string_view name(Precision precision) noexcept;
[[nodiscard]] std::string_view name(Health health) noexcept;

/// The form of A that a name or a word stands for.
[[nodiscard]] std::optional<OperatorKind> operator_called(std::string_view name_or_word) noexcept;

}  // namespace compueye::recon
