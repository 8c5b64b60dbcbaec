#include "studies/stability/hard_responses.hpp"
#include "tests/hard/hard_eyes.hpp"
#include "tests/hard/hard_row.hpp"

namespace compueye::tests {

using namespace firmware;

// clang-format off
std::vector<HardRow> conditioning_rows() {
  return {
      {.hard = {.name = "1.5 degrees", .reason = "Every ommatidium sees less than its share: most pixels are seen by none."}, .eye = narrow_eye},
      {.hard = {.name = "10 degrees", .reason = "Four neighbours share a pixel."}, .eye = eye_of_10_deg},
      {.hard = {.name = "60 degrees", .reason = "Nearly every ommatidium sees nearly every pixel."}, .eye = eye_of_60_deg},
      {.hard = {.name = "120 degrees", .reason = "Sections are hyperbolas: those that look aside see the plane to its end."}, .eye = widest_eye},
      {.hard = {.name = "80 x 80 at 15 degrees", .reason = "A condition of 1.8e5 and 25,600 pixels: no first-order method ends."}, .eye = large_eye, .iterations = 10,
       .solvers = "cp fista", .bases = "identity dct", .constraints = "none box", .judged = false},
      {.hard = {.name = "azimuth and elevation", .reason = "Axes crowd where the elevation is large, so no two rows are alike."}, .eye = azimuth_eye},
      {.hard = {.name = "tangent lattice", .reason = "Axes thin out to the sides."}, .eye = tangent_eye},
      {.hard = {.name = "plane of lenses", .reason = "All axes are parallel: sections are equal circles."}, .eye = plane_eye},
      {.hard = {.name = "cylinder", .reason = "Curved in one direction only."}, .eye = cylinder_eye},
      {.hard = {.name = "nearly flat eye", .reason = "Axes .01 degrees apart: rows differ in few pixels by little."}, .eye = flat_eye},
      {.hard = {.name = "identical axes", .reason = "Axes 1e-9 degrees apart: rows differ by rounding alone."}, .eye = one_axis_eye},
      {.hard = {.name = "measured rows", .reason = "Neither binary nor mirror images: what a calibration finds."}, .eye = measured_rows},
      {.hard = {.name = "unit 1e-18", .reason = "Squares of entries and samples are below what float32 keeps whole.", .response = {scaled, 1e-18}}, .eye = ordinary_eye},
      {.hard = {.name = "unit 1e18", .reason = "Squares of squares are beyond float32.", .response = {scaled, 1e18}}, .eye = ordinary_eye},
      {.hard = {.name = "one row times 1e-5", .reason = "A row that is nearly blind, and counts as seeing.", .response = {one_row, 1e-5}}, .eye = ordinary_eye},
      {.hard = {.name = "tall and equal", .reason = "More rows than pixels, and exactly repeated.", .response = {tall, 0.0}}, .eye = eye_of_60_deg},
  };
}
// clang-format on

}  // namespace compueye::tests
