#include "sim/scene/scene.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "sim/pictures/built_in_scenes.hpp"
#include "sim/scene/scene_truth.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye;
using hal::ErrorCode;

namespace {

hal::ObjectPlane plane(int rows, int cols, double width_mm, double height_mm) {
  hal::ObjectPlane object;
  object.rows = rows;
  object.cols = cols;
  object.width_mm = width_mm;
  object.height_mm = height_mm;
  return object;
}

double mean(const hal::Image& image) {
  return std::accumulate(image.pixels.begin(), image.pixels.end(), 0.0) / static_cast<double>(image.pixels.size());
}

}  // namespace

TEST_CASE("the truth of a scene with the plane's resolution and size is the picture itself") {
  const hal::ObjectPlane object = plane(48, 48, 7.3, 7.3);
  const hal::Image picture = sim::render_built_in("phantom", 48, 48, 3).value();
  CHECK(sim::scene_truth(sim::scene_on(object, "phantom", picture), object).value().pixels == picture.pixels);
}

TEST_CASE("the truth averages whole blocks and replicates whole pixels exactly") {
  hal::Image picture(4, 6);
  std::iota(picture.pixels.begin(), picture.pixels.end(), 0.0F);
  const hal::ObjectPlane coarse = plane(2, 3, 6.0, 4.0);
  const hal::Image small = sim::scene_truth(sim::scene_on(coarse, "ramp", picture), coarse).value();
  for (int r = 0; r < 2; ++r) {
    for (int c = 0; c < 3; ++c) {
      const float expected = (picture.at(2 * r, 2 * c) + picture.at(2 * r, 2 * c + 1) + picture.at(2 * r + 1, 2 * c) +
                              picture.at(2 * r + 1, 2 * c + 1)) /
                             4.0F;
      CHECK(small.at(r, c) == doctest::Approx(expected).epsilon(1e-6));
    }
  }
  const hal::ObjectPlane fine = plane(12, 12, 6.0, 4.0);
  const hal::Image large = sim::scene_truth(sim::scene_on(fine, "ramp", picture), fine).value();
  for (int r = 0; r < 12; ++r) {
    for (int c = 0; c < 12; ++c) CHECK(large.at(r, c) == doctest::Approx(picture.at(r / 3, c / 2)).epsilon(1e-6));
  }
}

TEST_CASE("the truth keeps the light at resolutions that do not divide") {
  const hal::Image picture = sim::render_built_in("line-art", 97, 61, 5).value();
  for (const auto& [rows, cols] : {std::pair{16, 16}, std::pair{53, 120}, std::pair{1, 1}}) {
    const hal::ObjectPlane object = plane(rows, cols, 9.0, 5.0);
    const hal::Image truth = sim::scene_truth(sim::scene_on(object, "line art", picture), object).value();
    CHECK(mean(truth) == doctest::Approx(mean(picture)).epsilon(1e-5));
  }
}

TEST_CASE("the truth is black beyond a small scene and cuts a large one") {
  const hal::ObjectPlane object = plane(4, 4, 4.0, 4.0);
  sim::Scene small = sim::scene_on(object, "white", hal::Image(5, 5, 1.0F));
  small.surfaces[0].width_mm = 2.0;
  small.surfaces[0].height_mm = 3.0;
  const hal::Image truth = sim::scene_truth(small, object).value();
  CHECK(truth.at(1, 0) == 0.0F);
  CHECK(truth.at(1, 1) == doctest::Approx(1.0));
  CHECK(truth.at(0, 1) == doctest::Approx(0.5));
  CHECK(mean(truth) * 16.0 == doctest::Approx(6.0));
  sim::Scene large = sim::scene_on(object, "white", hal::Image(3, 3, 0.25F));
  large.surfaces[0].width_mm = large.surfaces[0].height_mm = 40.0;
  const hal::Image grey = sim::scene_truth(large, object).value();
  for (const float pixel : grey.pixels) CHECK(pixel == doctest::Approx(0.25));
}

TEST_CASE("a scene begins anew after its duration, or goes on for ever") {
  sim::Scene scene = sim::scene_on(hal::ObjectPlane{}, "white", hal::Image(1, 1, 1.0F));
  CHECK(scene.own_time_s(1e5) == 1e5);
  scene.duration_s = 2.5;
  for (const auto& [start_s, own_s] :
       {std::pair{0.0, 0.0}, std::pair{2.25, 2.25}, std::pair{2.5, 0.0}, std::pair{8.0, 0.5}}) {
    CHECK(scene.own_time_s(start_s) == own_s);
  }
}

TEST_CASE("a scene that cannot be shown is refused with its name and the offending value") {
  const hal::ObjectPlane object;
  const auto refused = [&](const sim::Scene& scene, ErrorCode code, const test::Named& named) {
    test::check_error(sim::validate(scene), code, scene.name, named);
    CHECK_FALSE(sim::scene_truth(scene, object).has_value());
  };
  refused(sim::scene_on(object, "empty", hal::Image()), ErrorCode::out_of_range, {"0x0"});
  sim::Scene scene = sim::scene_on(object, "broken", hal::Image(3, 4, 0.5F));
  sim::Surface& sheet = scene.surfaces[0];
  CHECK(sim::validate(scene).has_value());
  for (const auto& [bad, text] : {std::pair{-0.1F, "-0.1"}, std::pair{std::numeric_limits<float>::quiet_NaN(), "nan"},
                                  std::pair{std::numeric_limits<float>::infinity(), "inf"}}) {
    sheet.bands[0].at(1, 2) = bad;
    refused(scene, ErrorCode::out_of_range, {"(1, 2)", text});
  }
  sheet.bands[0] = hal::Image(3, 4, 0.5F);
  sheet.bands[0].pixels.pop_back();
  refused(scene, ErrorCode::mismatch, {"11", "3x4"});
  sheet.bands[0] = hal::Image(3, 4, 0.5F);
  sheet.width_mm = 0.0;
  refused(scene, ErrorCode::out_of_range, {"width_mm", "0"});
  sheet.width_mm = -0.5;
  refused(scene, ErrorCode::out_of_range, {"width_mm", "-0.5"});
  sheet.width_mm = 1.0;
  sheet.height_mm = std::numeric_limits<double>::infinity();
  refused(scene, ErrorCode::out_of_range, {"height_mm", "inf"});
  sheet.height_mm = 1.0;
  sheet.distance_mm = -3.0;
  refused(scene, ErrorCode::out_of_range, {"distance_mm", "-3"});
}
