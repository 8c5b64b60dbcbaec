// Frames a second of sim::Renderer on the large simulated eye, one core, at .05 LSB of its board: 80x80 ommatidia of
// 60 degrees before pictures four times finer than its object plane of 160x160 pixels.
#include <cstdio>
#include <numbers>
#include <vector>

#include "bench/timing.hpp"
#include "sim/pictures/built_in_scenes.hpp"
#include "sim/random/random.hpp"
#include "sim/render/renderer.hpp"

using namespace compueye;

namespace {

constexpr double deg = std::numbers::pi / 180.0;
constexpr double lsb = 4096.0 / 65536.0;  // white pixels
const hal::ObjectPlane object{160, 160, 60.0, 60.0, 10.0};

hal::EyeGeometry large_eye() {
  hal::EyeGeometry eye;
  eye.rows = eye.columns = 80;
  eye.interommatidial_rad = 2.25 * deg;
  eye.acceptance_rad = 60.0 * deg;
  return eye;
}

hal::Image random_picture(int n) {
  sim::RandomStream random({1, sim::Draws::picture, 0, 7});
  hal::Image picture(n, n);
  for (float& pixel : picture.pixels) pixel = random.uniform(0, 1) < 0.5 ? 0.0F : 1.0F;
  return picture;
}

int measure(const char* what, const sim::Scene& scene, bool occlusion, int frames) {
  const hal::EyeGeometry eye = large_eye();
  sim::RenderSettings settings;
  settings.true_depth = settings.motion = true;
  settings.occlusion = occlusion;
  settings.tolerance = 0.05 * lsb;
  const double set_up = bench::milliseconds(
      [&] { (void)sim::Renderer::create(eye, object, sim::OpticsAsBuilt::drawn(eye), settings, scene); });
  auto renderer = sim::Renderer::create(eye, object, sim::OpticsAsBuilt::drawn(eye), settings, scene);
  if (!renderer) {
    std::fprintf(stderr, "%s\n", renderer.error().text().c_str());
    return 1;
  }
  std::vector<double> signals(static_cast<std::size_t>(eye.ommatidia()));
  const double first = bench::milliseconds([&] { renderer->render(0.0, signals); });
  std::vector<double> times;
  for (int frame = 1; frame <= frames; ++frame) {
    times.push_back(bench::milliseconds([&] { renderer->render(frame / 30.0, signals); }));
  }
  const double later = bench::median(times);
  std::printf("%-46s %8.0f ms set up  %8.0f ms first frame  %10.3f ms later (median of %d)  %9.1f frames/s\n", what,
              set_up, first, later, frames, 1000.0 / later);
  return 0;
}

}  // namespace

int main() {
  int failures = 0;
  const auto line_art = sim::render_built_in("line-art", 640, 640, 1);
  if (!line_art) return 1;
  sim::Scene scene = sim::scene_on(object, "line art", *line_art);
  failures += measure("still, line art", scene, false, 15);
  scene = sim::scene_on(object, "random", random_picture(640));
  failures += measure("still, random", scene, false, 15);
  scene.surfaces[0].motion.velocity_mm_per_s = {3.0, 1.0, 0.0};
  failures += measure("moving, random", scene, false, 7);
  scene.surfaces[0].bands = {*line_art};
  failures += measure("moving, line art", scene, false, 7);
  scene.surfaces[0].pose.tilt_rad = 15.0 * deg;
  failures += measure("moving and tilted, line art", scene, false, 3);
  sim::Surface front = scene.surfaces[0];
  front.bands = {random_picture(64)};
  front.width_mm = front.height_mm = 6.0;
  front.distance_mm = 6.0;
  front.motion = {};
  front.pose = {};
  front.name = "front";
  scene.surfaces.push_back(front);
  failures += measure("moving and tilted, line art, behind a still one", scene, true, 3);
  scene.surfaces[0].bands = {random_picture(640)};
  failures += measure("moving and tilted, random, behind a still one", scene, true, 3);
  std::swap(scene.surfaces[0].motion, scene.surfaces[1].motion);
  failures += measure("still and tilted, random, behind a moving one", scene, true, 3);
  scene.surfaces[0].bands = {*line_art};
  scene.surfaces[1].shape = sim::Shape::sphere;
  for (const bool white : {false, true}) {
    scene.surfaces[1].bands = {white ? hal::Image(640, 640, 1.0F) : *line_art};
    const char* what =
        white ? "still and tilted, behind a moving white ball" : "still and tilted, behind a moving ball of line art";
    failures += measure(what, scene, true, 3);
  }
  return failures == 0 ? 0 : 1;
}
