#include "recon/option_names.hpp"

#include <array>
#include <vector>

#include "recon/setup/basis_list.hpp"
#include "recon/setup/operator_list.hpp"
#include "recon/solver_list.hpp"

namespace compueye::recon {
namespace {

constexpr std::array<Named<ConstraintKind>, 3> constraints{{
    {"none", ConstraintKind::none},
    {"nonnegative", ConstraintKind::nonnegative},
    {"box", ConstraintKind::box},
}};

constexpr std::array<Named<Precision>, 2> precisions{{{"f32", Precision::f32}, {"f64", Precision::f64}}};

constexpr std::array<Named<Health>, 3> healths{
    {{"converged", Health::converged}, {"budget_used", Health::budget_used}, {"invalid", Health::invalid}}};

template <class Kind>
std::string_view name_in(std::span<const Named<Kind>> names, Kind kind) noexcept {
  for (const Named<Kind>& named : names) {
    if (named.kind == kind) return named.name;
  }
  return "unknown";
}

}  // namespace

std::span<const Named<SolverKind>> solver_names() noexcept {
  static const std::vector<Named<SolverKind>> names = [] {
    std::vector<Named<SolverKind>> all;
    for (const SolverKind solver : solvers()) all.push_back({solver->name, solver});
    return all;
  }();
  return names;
}

std::span<const Named<BasisKind>> basis_names() noexcept {
  static const std::vector<Named<BasisKind>> names = [] {
    std::vector<Named<BasisKind>> all;
    for (const BasisRow& basis : bases()) all.push_back({basis.name, basis.kind});
    return all;
  }();
  return names;
}

std::span<const Named<ConstraintKind>> constraint_names() noexcept {
  return constraints;
}

std::span<const Named<Precision>> precision_names() noexcept {
  return precisions;
}

std::span<const Named<OperatorKind>> operator_names() noexcept {
  static const std::vector<Named<OperatorKind>> names = [] {
    std::vector<Named<OperatorKind>> all;
    for (const OperatorRow& row : operators()) {
      if (!row.word.empty()) all.push_back({row.word, row.kind});
    }
    return all;
  }();
  return names;
}

std::string_view name(SolverKind kind) noexcept {
  return kind == nullptr ? "unknown" : kind->name;
}
std::string_view name(BasisKind kind) noexcept {
  return name_in(basis_names(), kind);
}
std::string_view name(ConstraintKind kind) noexcept {
  return name_in(constraint_names(), kind);
}

std::string_view name(Precision precision) noexcept {
  return name_in(precision_names(), precision);
}

std::string_view name(Health health) noexcept {
  return name_in(std::span<const Named<Health>>(healths), health);
}

std::string_view name(OperatorKind kind) noexcept {
  for (const OperatorRow& row : operators()) {
    if (row.kind == kind) return row.name;
  }
  return "unknown";
}

std::optional<OperatorKind> operator_called(std::string_view name_or_word) noexcept {
  for (const OperatorRow& row : operators()) {
    if (!name_or_word.empty() && (row.name == name_or_word || row.word == name_or_word)) return row.kind;
  }
  return std::nullopt;
}

}  // namespace compueye::recon
