#include "recon/option_names.hpp"

#include <array>

namespace compueye::recon {
namespace {

constexpr std::array<Named<SolverKind>, 8> solvers{{
    {"admm", SolverKind::admm},
    {"adm", SolverKind::adm},
    {"cp", SolverKind::chambolle_pock},
    {"fista", SolverKind::fista},
    {"omp", SolverKind::omp},
    {"pdhg", SolverKind::pdhg},
    {"tikhonov", SolverKind::tikhonov},
    {"tsvd", SolverKind::tsvd},
}};
constexpr std::array<Named<BasisKind>, 6> bases{{
    {"identity", BasisKind::identity},
    {"dct", BasisKind::dct},
    {"haar", BasisKind::haar},
    {"db4", BasisKind::db4},
    {"dft", BasisKind::dft},
    {"tv", BasisKind::tv},
}};
constexpr std::array<Named<OperatorKind>, 6> operators{{
    {"dense", OperatorKind::dense},
    {"csr", OperatorKind::csr},
    {"running-sums", OperatorKind::running_sums},
    {"dense-runs", OperatorKind::dense_runs},
    {"dense-runs-bf16", OperatorKind::dense_runs_bf16},
    {"dense-runs-int8", OperatorKind::dense_runs_int8},
}};
constexpr std::array<Named<ConstraintKind>, 3> constraints{{
    {"none", ConstraintKind::none},
    {"nonnegative", ConstraintKind::nonnegative},
    {"box", ConstraintKind::box},
}};

template <class Kind>
std::string_view name_in(std::span<const Named<Kind>> names, Kind kind) noexcept {
  for (const Named<Kind>& named : names) {
    if (named.kind == kind) return named.name;
  }
  return "unknown";
}

}  // namespace

std::span<const Named<SolverKind>> solver_names() noexcept {
  return solvers;
}
std::span<const Named<BasisKind>> basis_names() noexcept {
  return bases;
}
std::span<const Named<ConstraintKind>> constraint_names() noexcept {
  return constraints;
}

std::span<const Named<OperatorKind>> operator_names() noexcept {
  return operators;
}

std::string_view name(SolverKind kind) noexcept {
  if (kind == SolverKind::adm_as_published) return "adm as published";
  return name_in(solver_names(), kind);
}
std::string_view name(BasisKind kind) noexcept {
  return name_in(basis_names(), kind);
}
std::string_view name(ConstraintKind kind) noexcept {
  return name_in(constraint_names(), kind);
}

std::string_view name(OperatorKind kind) noexcept {
  switch (kind) {
    case OperatorKind::dense:
      return "dense";
    case OperatorKind::csr:
      return "csr";
    case OperatorKind::running_sums:
      return "running sums";
    case OperatorKind::running_sums_symmetric:
      return "running sums, four rows at once";
    case OperatorKind::running_sums_diagonal:
      return "running sums, eight rows at once";
    case OperatorKind::dense_runs:
      return "dense runs";
    case OperatorKind::dense_runs_bf16:
      return "dense runs in bf16";
    case OperatorKind::dense_runs_int8:
      return "dense runs in int8";
  }
  return "unknown";
}

}  // namespace compueye::recon
