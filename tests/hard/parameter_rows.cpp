#include "studies/stability/hard_responses.hpp"
#include "studies/stability/hard_samples.hpp"
#include "tests/hard/hard_eyes.hpp"
#include "tests/hard/hard_row.hpp"

namespace compueye::tests {

using namespace firmware;

// clang-format off
std::vector<HardRow> parameter_rows() {
  return {
      {.hard = {.name = "lambda 1e-9", .reason = "A step that fits the samples cannot feel the penalty.", .lambda_share = 1e-9}, .eye = ordinary_eye},
      {.hard = {.name = "lambda 1e-3", .reason = "As boards choose it.", .lambda_share = 1e-3}, .eye = ordinary_eye},
      {.hard = {.name = "lambda at the largest", .reason = "The least lambda that makes the picture nought, and a little.", .lambda_share = 1.0001}, .eye = ordinary_eye, .must = Must::be_zero,
       .bases = "identity dct haar db4 dft"},
      {.hard = {.name = "lambda twice the largest", .reason = "A picture of nought on rows without symmetry.", .lambda_share = 2.0}, .eye = measured_rows, .must = Must::be_zero,
       .bases = "identity dct haar db4 dft"},
      {.hard = {.name = "lambda just below the largest", .reason = "A single coefficient is left.", .lambda_share = 0.98}, .eye = ordinary_eye},
      {.hard = {.name = "lambda nought", .reason = "No penalty: the constraint alone chooses among pictures that fit.", .lambda_share = 0.0}, .eye = ordinary_eye, .solvers = "admm adm cp fista pdhg"},
      {.hard = {.name = "rho at its least", .reason = "The factor is as ill-conditioned as set-up allows."}, .eye = ordinary_eye, .solvers = "admm pdhg", .rho_share = 1.0},
      {.hard = {.name = "rho a little below", .reason = "Rounding would decide the picture."}, .eye = ordinary_eye, .must = Must::be_refused, .solvers = "admm pdhg", .rho_share = 0.5, .place = "rho"},
      {.hard = {.name = "rho at its most", .reason = "Steps are so short that nothing moves."}, .eye = ordinary_eye, .solvers = "admm pdhg", .rho_share = -1.0},
      {.hard = {.name = "rho a little above", .reason = "The factor would be a multiple of one."}, .eye = ordinary_eye, .must = Must::be_refused, .solvers = "admm pdhg", .rho_share = -2.0, .place = "rho"},
      {.hard = {.name = "K = 1", .reason = "One iteration: whatever it has, it hands out."}, .eye = ordinary_eye, .iterations = 1},
      {.hard = {.name = "K = 1 of measured rows", .reason = "One iteration without symmetry to help."}, .eye = measured_rows, .iterations = 1},
      {.hard = {.name = "K = 1e6", .reason = "A million roundings add up, and duals have all the time to decay."}, .eye = line_picture, .iterations = 1'000'000,
       .solvers = "admm cp pdhg", .bases = "identity", .constraints = "box"},
  };
}
// clang-format on

std::vector<HardRow> product_rows() {
  std::vector<HardRow> rows;
  for (const HardCase& hard : hard_cases()) {
    HardRow row{.hard = hard, .eye = ordinary_eye};
    const bool beyond = hard.lambda_share >= 1.0;
    if (beyond || (hard.samples.apply == all_times && hard.samples.amount == 0.0)) row.must = Must::be_zero;
    if (beyond) row.bases = "identity dct haar db4 dft";
    rows.push_back(row);
  }
  return rows;
}

}  // namespace compueye::tests
