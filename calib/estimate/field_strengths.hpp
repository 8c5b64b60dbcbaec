#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "calib/estimate/row_parameters.hpp"

namespace compueye::calib {

/// How large the departures of rows from their cones are expected to be: standard deviation of each knot of a field, in
/// the order of Field. 0: there is no such field.
using FieldStrengths = std::array<double, field_kinds>;

/// All that are tried. The first is none at all.
[[nodiscard]] std::span<const FieldStrengths> field_strengths() noexcept;

/// How common each of them is among rows, from the log likelihood of the patterns held out (a row each, by
/// field_strengths()): a mixture fitted by expectation and maximisation (Dempster, Laird & Rubin 1977, "Maximum
/// likelihood from incomplete data via the EM algorithm"). A row's own patterns tell little; of what is common its
/// choice then needs less evidence. Returns logarithms.
[[nodiscard]] std::vector<double> log_shares(const std::vector<std::vector<double>>& log_likelihoods);

}  // namespace compueye::calib
