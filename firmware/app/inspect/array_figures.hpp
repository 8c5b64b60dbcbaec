#pragma once

#include "firmware/app/inspect/figure_list.hpp"
#include "firmware/files/npy.hpp"

namespace compueye::firmware {

/// Shape, range and mean of the finite elements, and how many are NaN or infinite.
void add_array_figures(const NpyArray& array, FigureList& figures);

}  // namespace compueye::firmware
