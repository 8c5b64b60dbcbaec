#include "sim/plan/preview.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "hal/try.hpp"
#include "sim/effects/band_weights.hpp"
#include "sim/plan/times_to_look.hpp"
#include "sim/render/renderer.hpp"

namespace compueye::sim {
namespace {

using Levels = std::vector<double>;

/// Means over blocks, so that a pixel is about `pixel_mm` wide.
hal::Image coarsened(const hal::Image& picture, double width_mm, double height_mm, double pixel_mm) {
  const auto pixels = [&](double side_mm, int at_most) {
    return static_cast<int>(std::clamp(std::ceil(side_mm / pixel_mm), 1.0, static_cast<double>(at_most)));
  };
  hal::Image coarse(pixels(height_mm, picture.rows), pixels(width_mm, picture.cols));
  const auto first = [](int block, int blocks, int all) {
    return static_cast<int>((static_cast<long>(block) * all + blocks - 1) / blocks);
  };
  std::vector<float> columns(static_cast<std::size_t>(picture.cols));
  for (int r = 0; r < coarse.rows; ++r) {
    const int top = first(r, coarse.rows, picture.rows), bottom = first(r + 1, coarse.rows, picture.rows);
    std::fill(columns.begin(), columns.end(), 0.0F);
    for (int row = top; row < bottom; ++row) {
      const float* pixels_of_row = picture.pixels.data() + static_cast<std::size_t>(row) * columns.size();
      for (std::size_t col = 0; col < columns.size(); ++col) columns[col] += pixels_of_row[col];
    }
    for (int c = 0; c < coarse.cols; ++c) {
      const int left = first(c, coarse.cols, picture.cols), right = first(c + 1, coarse.cols, picture.cols);
      const float sum = std::accumulate(columns.begin() + left, columns.begin() + right, 0.0F);
      coarse.at(r, c) = sum / static_cast<float>((bottom - top) * (right - left));
    }
  }
  return coarse;
}

/// What a quarter of an ommatidium's view is wide on the object plane.
double look_mm(const EyeToSimulate& board) {
  return std::max(board.object.distance_mm * std::tan(board.eye.acceptance_rad / 2.0) / 2.0, 1e-6);
}

/// Reliefs stay as they are: what hides behind a step is told by how steep it is, and what a step moves by how fine
/// its picture is.
Scene coarse_scene(const EyeToSimulate& board, const Scene& scene) {
  Scene coarse = scene;
  for (Surface& surface : coarse.surfaces) {
    if (surface.shape == Shape::relief) continue;
    if (surface.bands.size() == 3) surface.bands = {surface.weighed(band_weights(board, scene, surface))};
    for (hal::Image& band : surface.bands) {
      band = coarsened(band, surface.width_mm, surface.height_mm, look_mm(board));
    }
  }
  return lit(std::move(coarse));
}

/// Several surfaces each other, a relief itself.
bool may_hide(const Scene& scene) {
  return scene.surfaces.size() > 1 || scene.surfaces.front().shape == Shape::relief;
}

/// How a look is rendered, and when.
struct Glance {
  double t_s = 0.0;
  bool depth = true, occlusion = true;
  double right_mm = 0.0, up_mm = 0.0;
};

/// How many looks there are to be, and who is told of them.
struct Looking {
  const EyeToSimulate& board;
  const RenderWatch& watch;
  double looks = 1.0;
  double done = 0.0;
};

hal::Result<Levels> levels_of(Looking& looking, Scene scene, const Glance& glance) {
  const EyeToSimulate& board = looking.board;
  for (Surface& surface : scene.surfaces) {
    surface.pose.centre_mm.x += glance.right_mm;
    surface.pose.centre_mm.y += glance.up_mm;
  }
  RenderSettings settings;
  const double white = board.eye.acceptance_rad * board.object.distance_mm /
                       std::sqrt(board.object.pixel_width_mm() * board.object.pixel_height_mm());
  settings.tolerance = 1e-3 * std::max(white * white, 1e-6);
  settings.motion = true;
  settings.true_depth = glance.depth;
  settings.occlusion = glance.occlusion && may_hide(scene);
  Renderer renderer = TRY(Renderer::create(board.eye, board.object, OpticsAsBuilt::drawn(board.eye), settings, scene));
  Levels levels(static_cast<std::size_t>(board.eye.ommatidia()));
  const auto told = [&](double share) {
    return looking.watch("looking at the scene", (looking.done + share) / looking.looks);
  };
  if (!renderer.render(glance.t_s, levels, looking.watch ? Renderer::Watch(told) : Renderer::Watch())) {
    return hal::fail(hal::ErrorCode::interrupted, scene.name, "the look at it was stopped");
  }
  looking.done += 1.0;
  for (double& level : levels) level /= board.sensor.lsb();
  return levels;
}

double rms(const Levels& values) {
  double sum = 0.0;
  for (const double v : values) sum += v * v;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

void add_neighbours(const hal::EyeGeometry& eye, Preview& preview) {
  const auto at = [&](int i, int k) {
    return preview
        .levels[static_cast<std::size_t>(i) * static_cast<std::size_t>(eye.columns) + static_cast<std::size_t>(k)];
  };
  double squares = 0.0;
  for (int i = 0; i < eye.rows; ++i) {
    for (int k = 0; k < eye.columns; ++k) {
      double sum = 0.0;
      int count = 0;
      for (const auto& [down, right] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
        if (i + down < 0 || i + down >= eye.rows || k + right < 0 || k + right >= eye.columns) continue;
        sum += at(i + down, k + right);
        ++count;
      }
      if (count > 0) squares += std::pow(at(i, k) - sum / count, 2);
    }
  }
  preview.neighbour_rms = std::sqrt(squares / static_cast<double>(preview.levels.size()));
}

bool has_relief(const Scene& scene) {
  return std::any_of(scene.surfaces.begin(), scene.surfaces.end(),
                     [](const Surface& surface) { return surface.shape == Shape::relief; });
}

/// By moving the scene to both sides. A relief takes longest and is as steep when it is pressed flat.
hal::Result<void> add_slopes(Looking& looking, const Scene& scene, double t_s, const Levels& look, Preview& preview) {
  const double step = look_mm(looking.board) / 2.0;
  const bool pressed = has_relief(scene);
  Glance glance{.t_s = t_s, .depth = !pressed, .occlusion = !pressed};
  const Levels middle = pressed ? TRY(levels_of(looking, scene, glance)) : look;
  const auto moved = [&](double right, double up) {
    glance.right_mm = right;
    glance.up_mm = up;
    return levels_of(looking, scene, glance);
  };
  for (const auto& [right, up] : {std::pair{step, 0.0}, {0.0, step}}) {
    const Levels after = TRY(moved(right, up)), before = TRY(moved(-right, -up));
    Levels slope(after.size()), bend(after.size());
    for (std::size_t m = 0; m < after.size(); ++m) {
      slope[m] = (after[m] - before[m]) / (2.0 * step);
      bend[m] = (after[m] + before[m] - 2.0 * middle[m]) / (step * step);
      preview.gradient_largest = std::max(preview.gradient_largest, std::fabs(slope[m]));
    }
    preview.gradient_rms = std::max(preview.gradient_rms, rms(slope));
    preview.laplacian_rms = std::max(preview.laplacian_rms, rms(bend));
  }
  return {};
}

double rms_between(const Levels& a, const Levels& b) {
  Levels difference(a.size());
  for (std::size_t m = 0; m < a.size(); ++m) difference[m] = a[m] - b[m];
  return rms(difference);
}

bool lies_on_the_plane(const Surface& surface, const hal::ObjectPlane& object) {
  const double distance = object.distance_mm;
  const bool straight = surface.pose.tilt_rad == 0.0 && surface.pose.lean_rad == 0.0 && surface.motion.still();
  return surface.shape == Shape::plane && straight && surface.distance_mm.value_or(distance) == distance;
}

bool lies_flat(const Scene& scene, const hal::ObjectPlane& object) {
  return std::all_of(scene.surfaces.begin(), scene.surfaces.end(),
                     [&](const Surface& surface) { return lies_on_the_plane(surface, object); });
}

/// What each of depth, occlusion and motion changes, at the time of which it is most: no one knows which frames of a
/// scene will be taken.
hal::Result<void> add_changes(Looking& looking, const Scene& scene, const std::vector<double>& times,
                              const std::vector<Levels>& looks, Preview& preview) {
  const bool flat = lies_flat(scene, looking.board.object), alone = !may_hide(scene);
  double of_depth = 0.0, of_occlusion = 0.0, of_motion = 0.0;
  for (std::size_t k = 0; k < times.size(); ++k) {
    if (!flat) {
      const Levels changed = TRY(levels_of(looking, scene, {.t_s = times[k], .depth = false}));
      of_depth = std::max(of_depth, rms_between(looks[k], changed));
    }
    if (!alone) {
      const Levels changed = TRY(levels_of(looking, scene, {.t_s = times[k], .occlusion = false}));
      of_occlusion = std::max(of_occlusion, rms_between(looks[k], changed));
    }
    of_motion = std::max(of_motion, rms_between(looks[k], looks[0]));
  }
  if (!flat) preview.flat_change = of_depth;
  if (!alone) preview.shine_through_change = of_occlusion;
  if (!scene.still()) preview.standstill_change = of_motion;
  return {};
}

/// At each time as it is, flat and without what hides, and at two of what moves from four sides, for a relief from the
/// front as well.
double looks_at(const Scene& scene, const hal::ObjectPlane& object, std::size_t times) {
  const int each = 1 + (lies_flat(scene, object) ? 0 : 1) + (may_hide(scene) ? 1 : 0);
  return static_cast<double>(times) * each + (scene.still() ? 1.0 : 2.0) * (4.0 + (has_relief(scene) ? 1.0 : 0.0));
}

}  // namespace

hal::Result<Preview> preview_of(const EyeToSimulate& board, const Scene& scene, const RenderWatch& watch) {
  const Scene coarse = coarse_scene(board, scene);
  const std::vector<double> times = times_to_look(coarse);
  std::vector<Levels> looks;
  Looking looking{board, watch, looks_at(coarse, board.object, times.size())};
  for (const double t_s : times) looks.push_back(TRY(levels_of(looking, coarse, {.t_s = t_s})));
  const auto brightest =
      std::max_element(looks.begin(), looks.end(), [](const Levels& a, const Levels& b) { return rms(a) < rms(b); });
  Preview preview;
  preview.levels = *brightest;
  for (const double level : preview.levels) {
    preview.mean += level / static_cast<double>(preview.levels.size());
    preview.largest = std::max(preview.largest, level);
  }
  preview.rms = rms(preview.levels);
  add_neighbours(board.eye, preview);
  // Slopes are steepest where it is bright, or where something has come before what is bright.
  const auto most_moved = std::max_element(looks.begin(), looks.end(), [&](const Levels& a, const Levels& b) {
    return rms_between(a, looks[0]) < rms_between(b, looks[0]);
  });
  for (const auto& look : brightest == most_moved ? std::vector{brightest} : std::vector{brightest, most_moved}) {
    TRY(add_slopes(looking, coarse, times[static_cast<std::size_t>(look - looks.begin())], *look, preview));
  }
  TRY(add_changes(looking, coarse, times, looks, preview));
  return preview;
}

}  // namespace compueye::sim
