#include "firmware/app/board/reconstruction_names.hpp"

#include <array>

namespace compueye::firmware {
namespace {

constexpr std::array<Named<recon::SolverKind>, 2> solvers{{
    {"admm", recon::SolverKind::admm},
    {"tikhonov", recon::SolverKind::tikhonov},
}};
constexpr std::array<Named<recon::BasisKind>, 2> bases{{
    {"identity", recon::BasisKind::identity},
    {"dct", recon::BasisKind::dct},
}};
constexpr std::array<Named<recon::ConstraintKind>, 3> constraints{{
    {"none", recon::ConstraintKind::none},
    {"nonnegative", recon::ConstraintKind::nonnegative},
    {"box", recon::ConstraintKind::box},
}};

template <class Kind>
std::string_view name_in(std::span<const Named<Kind>> names, Kind kind) noexcept {
  for (const Named<Kind>& named : names) {
    if (named.kind == kind) return named.name;
  }
  return "unknown";
}

}  // namespace

std::span<const Named<recon::SolverKind>> solver_names() noexcept {
  return solvers;
}
std::span<const Named<recon::BasisKind>> basis_names() noexcept {
  return bases;
}
std::span<const Named<recon::ConstraintKind>> constraint_names() noexcept {
  return constraints;
}

std::string_view name(recon::SolverKind kind) noexcept {
  return name_in(solver_names(), kind);
}
std::string_view name(recon::BasisKind kind) noexcept {
  return name_in(basis_names(), kind);
}
std::string_view name(recon::ConstraintKind kind) noexcept {
  return name_in(constraint_names(), kind);
}

}  // namespace compueye::firmware
