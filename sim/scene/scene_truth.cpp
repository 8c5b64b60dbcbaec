#include "sim/scene/scene_truth.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "hal/try.hpp"

namespace compueye::sim {
namespace {

/// How much of one target pixel each source pixel covers, along one axis.
struct Overlap {
  int target = 0, source = 0;
  double share = 0.0;
};

// Both extents are centred on zero; a target edge t is at t * target_size / targets - target_size / 2.
std::vector<Overlap> overlaps(int sources, double source_size, int targets, double target_size) {
  std::vector<Overlap> result;
  const double per_source = target_size / targets * sources / source_size;  // source pixels in a target pixel
  const double first = (1.0 - target_size / source_size) / 2.0 * sources;   // left edge of target 0 in source pixels
  for (int target = 0; target < targets; ++target) {
    const double lo = first + target * per_source;
    const double hi = first + (target + 1) * per_source;
    const int from = static_cast<int>(std::clamp(std::floor(lo), 0.0, static_cast<double>(sources)));
    const int to = static_cast<int>(std::clamp(std::ceil(hi), 0.0, static_cast<double>(sources)));
    for (int source = from; source < to; ++source) {
      const double covered = std::min(hi, source + 1.0) - std::max(lo, static_cast<double>(source));
      if (covered > 1e-12 * per_source) result.push_back({target, source, covered / per_source});
    }
  }
  return result;
}

}  // namespace

hal::Result<hal::Image> scene_truth(const Scene& scene, const hal::ObjectPlane& object) {
  TRY(validate(scene));
  TRY(object.validate());
  const Surface& sheet = scene.surfaces.front();
  const hal::Image& picture = sheet.picture();
  if (picture.rows == object.rows && picture.cols == object.cols && sheet.width_mm == object.width_mm &&
      sheet.height_mm == object.height_mm) {
    return picture;
  }
  const auto across = overlaps(picture.cols, sheet.width_mm, object.cols, object.width_mm);
  const auto down = overlaps(picture.rows, sheet.height_mm, object.rows, object.height_mm);
  std::vector<double> sums(static_cast<std::size_t>(object.pixels()), 0.0);
  for (const Overlap& v : down) {
    for (const Overlap& u : across) {
      const auto pixel = static_cast<std::size_t>(v.target) * static_cast<std::size_t>(object.cols) +
                         static_cast<std::size_t>(u.target);
      sums[pixel] += v.share * u.share * static_cast<double>(picture.at(v.source, u.source));
    }
  }
  hal::Image truth(object.rows, object.cols);
  std::transform(sums.begin(), sums.end(), truth.pixels.begin(), [](double sum) { return static_cast<float>(sum); });
  return truth;
}

}  // namespace compueye::sim
