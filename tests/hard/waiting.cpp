#include <algorithm>
#include <array>

#include "tests/hard/hard_row.hpp"

namespace compueye::tests {
namespace {

constexpr std::string_view black = "a picture of nought beyond the largest lambda";
constexpr std::string_view unit = "a change of unit changes nothing but the unit";

constexpr std::array<Waiting, 28> known{{
    {"lambda beyond", "admm", "*", "*", black},
    {"lambda beyond", "cp", "*", "*", black},
    {"lambda beyond", "pdhg", "*", "*", black},
    {"lambda 1e6", "admm", "*", "*", black},
    {"lambda 1e6", "cp", "*", "*", black},
    {"lambda 1e6", "pdhg", "*", "*", black},
    {"lambda at the largest", "admm", "*", "*", black},
    {"lambda at the largest", "cp", "*", "*", black},
    {"lambda at the largest", "pdhg", "*", "*", black},
    {"lambda twice the largest", "admm", "*", "*", black},
    {"lambda twice the largest", "cp", "*", "*", black},
    {"lambda twice the largest", "pdhg", "*", "*", black},
    {"lambda half", "admm", "*", "no worse than dark", black},
    {"lambda half", "pdhg", "*", "no worse than dark", black},
    {"lambda just below the largest", "admm", "*", "no worse than dark", black},
    {"lambda just below the largest", "cp", "*", "no worse than dark", black},
    {"lambda just below the largest", "pdhg", "*", "no worse than dark", black},
    {"negative outlier", "admm", "*", "no worse than dark", black},
    {"negative outlier", "adm", "*", "no worse than dark", black},
    {"negative outlier", "pdhg", "*", "no worse than dark", black},
    {"unit 1e-30", "*", "*", "solved", unit},
    {"unit 1e30", "*", "*", "solved", unit},
    {"unit 1e-18", "*", "*", "solved", unit},
    {"unit 1e18", "*", "*", "solved", unit},
    {"samples near the largest float", "*", "f32", "finite", unit},
    {"subnormal samples", "tikhonov", "f32", "converged", unit},
    {"rank one", "omp", "*", "no worse than dark", "omp: atoms that rounding makes dependent"},
    {"identical axes", "omp", "*", "no worse than dark", "omp: atoms that rounding makes dependent"},
}};

}  // namespace

std::span<const Waiting> waiting() noexcept {
  return known;
}

bool lists(std::string_view list, std::string_view word) noexcept {
  if (list.empty()) return true;
  while (!list.empty()) {
    const std::string_view each = list.substr(0, list.find(' '));
    if (each == word) return true;
    list.remove_prefix(std::min(list.size(), each.size() + 1));
  }
  return false;
}

}  // namespace compueye::tests
