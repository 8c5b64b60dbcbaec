#include "sim/scene/scene_truth.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "hal/try.hpp"
#include "sim/scene/view_along_z.hpp"

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

/// One upright sheet in the middle, grey, whatever its distance.
bool is_plain(const Scene& scene) noexcept {
  if (scene.surfaces.size() != 1 || !scene.still()) return false;
  const Surface& sheet = scene.surfaces.front();
  const Pose& pose = sheet.pose;
  return sheet.shape == Shape::plane && sheet.bands.size() == 1 && pose.tilt_rad == 0.0 && pose.lean_rad == 0.0 &&
         pose.roll_rad == 0.0 && pose.centre_mm.x == 0.0 && pose.centre_mm.y == 0.0;
}

hal::Image sheet_on(const Surface& sheet, const hal::ObjectPlane& object) {
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

}  // namespace

hal::Result<hal::Image> scene_truth(const Scene& scene, const hal::ObjectPlane& object, double t_s) {
  TRY(validate(scene));
  TRY(object.validate());
  const Scene seen = lit(scene);
  if (is_plain(seen)) return sheet_on(seen.surfaces.front(), object);
  return view_along_z(seen, object, t_s);
}

}  // namespace compueye::sim
