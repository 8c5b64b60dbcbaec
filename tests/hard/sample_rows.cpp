#include <limits>

#include "studies/stability/hard_responses.hpp"
#include "studies/stability/hard_samples.hpp"
#include "tests/hard/hard_eyes.hpp"
#include "tests/hard/hard_row.hpp"

namespace compueye::tests {

using namespace firmware;

namespace {

void nan_unmasked(HardProblem& problem, double) {
  problem.y[3] = std::numeric_limits<float>::quiet_NaN();
}
void infinite_unmasked(HardProblem& problem, double) {
  problem.y[3] = -std::numeric_limits<float>::infinity();
}
void all_masked(HardProblem& problem, double) {
  problem.weights.assign(problem.y.size(), 0.0F);
}
void weight_of_two(HardProblem& problem, double) {
  problem.weights.assign(problem.y.size(), 1.0F);
  problem.weights[2] = 2.0F;
}

}  // namespace

// clang-format off
std::vector<HardRow> sample_rows() {
  return {
      {.hard = {.name = "SNR 0 dB", .reason = "As much noise as signal.", .snr_db = 0.0, .lambda_share = 0.1}, .eye = ordinary_eye},
      {.hard = {.name = "SNR 20 dB", .reason = "A tenth of noise.", .snr_db = 20.0}, .eye = ordinary_eye},
      {.hard = {.name = "SNR 60 dB", .reason = "Small singular values carry what is sought, and take long.", .snr_db = 60.0, .lambda_share = 1e-3}, .eye = ordinary_eye},
      {.hard = {.name = "no noise", .reason = "Samples exact to float32, at a lambda that leaves them so.", .snr_db = std::numeric_limits<double>::infinity(), .lambda_share = 1e-4}, .eye = ordinary_eye},
      {.hard = {.name = "subnormal samples", .reason = "1e-39 and less: a processor may be a hundred times slower, or read nought.", .samples = {all_times, 1e-39}}, .eye = ordinary_eye},
      {.hard = {.name = "samples in lsb", .reason = "Codes up to 4095 instead of white pixels.", .samples = {all_times, 409.0}}, .eye = ordinary_eye},
      {.hard = {.name = "samples in ampere", .reason = "Photo currents of a nanoampere.", .samples = {all_times, 1e-9}}, .eye = ordinary_eye},
      {.hard = {.name = "samples near the largest float", .reason = "Their squares are no float32.", .samples = {all_times, 1e25}}, .eye = ordinary_eye},
      {.hard = {.name = "outlier 1e12", .reason = "One sample beyond all others by more than float32's digits.", .samples = {one_outlier, 1e12}}, .eye = ordinary_eye},
      {.hard = {.name = "negative outlier", .reason = "A sample that pulls everything below nought.", .samples = {one_outlier, -1e3}}, .eye = ordinary_eye},
      {.hard = {.name = "a third saturated", .reason = "Flat tops where the details are.", .samples = {saturated, 0.1}}, .eye = ordinary_eye},
      {.hard = {.name = "hot channels known", .reason = "A tenth reads infinity and weighs nothing.", .samples = {hot_known, 0.1}}, .eye = ordinary_eye},
      {.hard = {.name = "half dead and known", .reason = "Far more than a frame is planned for may be missing.", .samples = {dead_known, 0.5}}, .eye = ordinary_eye},
      {.hard = {.name = "half dead and unknown", .reason = "Every other sample lies.", .samples = {dead_unknown, 0.5}}, .eye = ordinary_eye},
      {.hard = {.name = "one channel left", .reason = "All weights but one are nought.", .samples = {one_channel, 0.0}}, .eye = ordinary_eye},
      {.hard = {.name = "no channel left", .reason = "All weights are nought: nothing is asked, so nought is answered.", .samples = {all_masked, 0.0}}, .eye = ordinary_eye, .must = Must::be_zero},
      {.hard = {.name = "a NaN that weighs", .reason = "It would spread to every pixel.", .samples = {nan_unmasked, 0.0}}, .eye = ordinary_eye, .must = Must::be_invalid},
      {.hard = {.name = "an infinity that weighs", .reason = "Infinity less infinity is NaN.", .samples = {infinite_unmasked, 0.0}}, .eye = ordinary_eye, .must = Must::be_invalid},
      {.hard = {.name = "a weight of two", .reason = "Beyond what a weight may be.", .samples = {weight_of_two, 0.0}}, .eye = ordinary_eye, .must = Must::be_invalid},
      {.hard = {.name = "no x >= 0 explains them", .reason = "Every sample is below nought: with x >= 0 the answer is black.", .samples = {all_times, -1.0}}, .eye = ordinary_eye, .must = Must::be_zero,
       .bases = "identity", .constraints = "nonnegative box"},
      {.hard = {.name = "dark measured rows", .reason = "Nought from rows that have no symmetry.", .samples = {all_times, 0.0}}, .eye = measured_rows, .must = Must::be_zero},
  };
}
// clang-format on

}  // namespace compueye::tests
