#include "studies/stability/hard_responses.hpp"
#include "studies/stability/hard_samples.hpp"
#include "tests/hard/hard_eyes.hpp"
#include "tests/hard/hard_row.hpp"

namespace compueye::tests {

using namespace firmware;

// clang-format off
std::vector<HardRow> degenerate_rows() {
  return {
      {.hard = {.name = "nothing seen at all", .reason = "A is all zero: there is nothing to solve."}, .eye = zero_response, .must = Must::be_refused, .place = "response"},
      {.hard = {.name = "one pixel of one row", .reason = "Five of six rows are blind, 63 of 64 pixels unseen."}, .eye = sees_last_pixel},
      {.hard = {.name = "nine rows in ten blind", .reason = "Two or three samples are all there is.", .response = {blinded, 0.9}}, .eye = ordinary_eye},
      {.hard = {.name = "half of the pixels unseen", .reason = "Only penalty and constraint say anything about them.", .response = {unseen, 0.5}}, .eye = ordinary_eye},
      {.hard = {.name = "M = 1", .reason = "A A' is a single number.", .response = {first_row, 0.0}}, .eye = eye_of_10_deg},
      {.hard = {.name = "N = 1", .reason = "A picture of one pixel: no differences, no wavelets, one cosine."}, .eye = one_pixel},
      {.hard = {.name = "M = N = 1", .reason = "One number from one number."}, .eye = one_of_each},
      {.hard = {.name = "M > N", .reason = "The factor is on the longer side.", .response = {tall, 0.05}}, .eye = eye_of_10_deg},
      {.hard = {.name = "twin pixels", .reason = "Differences of neighbours are atoms of nothing but float32's rounding."}, .eye = twin_pixels},
      {.hard = {.name = "near twin pixels", .reason = "Atoms of differences are 1e-4 of the others, and rounded as these are."}, .eye = near_twin_pixels},
      {.hard = {.name = "25 rows a pixel", .reason = "What is square in the rows is 625 times what is square in the pixels."}, .eye = tall_rows},
      {.hard = {.name = "25 rows a pixel of an eye", .reason = "The same rows again and again, each a little off."}, .eye = tall_eye},
      {.hard = {.name = "25 rows a pixel across 1e6", .reason = "Squares of the weak rows are below the rounding of the strong ones' squares.", .response = {row_spread, 1e6}}, .eye = tall_rows},
      {.hard = {.name = "25 rows a pixel, one times 1e5", .reason = "On the side of the pixels no row can be turned down.", .response = {one_row, 1e5}}, .eye = tall_rows},
      {.hard = {.name = "25 rows a pixel, rank one", .reason = "All singular values but one are rounding.", .response = {rank_one, 0.0}}, .eye = tall_rows},
      {.hard = {.name = "25 rows a pixel, rank one and a little", .reason = "All singular values but one are 1e-5 of it or less.", .response = {rank_one, 1e-5}}, .eye = tall_rows},
      {.hard = {.name = "25 rows a pixel, half of them blind", .reason = "What is tall is decided by the rows that see.", .response = {blinded, 0.5}}, .eye = tall_rows},
      {.hard = {.name = "25 rows a pixel, a quarter of these unseen", .reason = "A'A is singular.", .response = {unseen, 0.25}}, .eye = tall_rows},
      {.hard = {.name = "25 rows a pixel, a third dead and known", .reason = "More channels are missing than there are pixels.", .samples = {dead_known, 0.34}}, .eye = tall_rows},
      {.hard = {.name = "25 rows a pixel of an eye, weights across 1e9", .reason = "Every channel has a weight of its own.", .samples = {weight_spread, 1e-9}}, .eye = tall_eye},
      {.hard = {.name = "7 x 9 pixels", .reason = "No side is even: a wavelet has no level at all."}, .eye = odd_picture},
      {.hard = {.name = "6 x 10 pixels", .reason = "Both sides are even once: a wavelet has one level, db4 none."}, .eye = half_odd_picture},
      {.hard = {.name = "1 x 12 pixels", .reason = "A picture that is a line: differences in one direction only."}, .eye = line_picture},
  };
}
// clang-format on

}  // namespace compueye::tests
