#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "calib/estimate/captures.hpp"

namespace compueye::calib {

/// White split into two pictures that have no lit pixel in common: mean codes of M channels, taken one after the other
/// in this order, so that a light that drifts evenly cancels.
struct SplitWhite {
  std::vector<double> part, whole, rest;  ///< NaN: this channel has nothing
};

/// How much a converter bows, told by light that adds up while its codes do not (flux addition; needs no light of known
/// level and no display of known gamma): with part, rest, whole and black, code(part) + code(rest) - code(whole) -
/// code(black) is 2 q (part - black) (rest - black) where code = v + q v (F - v), F the largest code. A channel whose q
/// is not three standard errors from 0, by the scatter of at least three splits, is straight.
///
/// A table a channel, or none at all where every channel is straight. `black`: mean codes of a black picture, M.
[[nodiscard]] std::vector<LinearityTable> linearity_tables(std::span<const SplitWhite> splits,
                                                           std::span<const double> black, double largest_code);

}  // namespace compueye::calib
