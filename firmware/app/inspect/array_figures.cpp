#include "firmware/app/inspect/array_figures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "firmware/files/npy_header.hpp"
#include "firmware/text/number_text.hpp"

namespace compueye::firmware {

void add_array_figures(const NpyArray& array, FigureList& figures) {
  double least = std::numeric_limits<double>::infinity(), most = -least, sum = 0.0;
  std::int64_t finite = 0;
  for (const double value : array.values) {
    if (!std::isfinite(value)) continue;
    least = std::min(least, value);
    most = std::max(most, value);
    sum += value;
    ++finite;
  }
  const auto non_finite = static_cast<std::int64_t>(array.values.size()) - finite;
  figures.add("shape", "shape", shape_text(array.shape), array.shape);
  if (finite > 0) {
    figures.add("min", "smallest", significant(least, 6), least);
    figures.add("max", "largest", significant(most, 6), most);
    figures.add("mean", "mean", significant(sum / static_cast<double>(finite), 6), sum / static_cast<double>(finite));
  }
  figures.add("non_finite", "NaN or infinite", grouped(non_finite), non_finite);
}

}  // namespace compueye::firmware
