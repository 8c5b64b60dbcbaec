#include <array>
#include <limits>

#include "studies/stability/hard_case.hpp"
#include "studies/stability/hard_responses.hpp"
#include "studies/stability/hard_samples.hpp"

namespace compueye::firmware {
namespace {

// clang-format off
constexpr std::array<HardCase, 37> cases{{
    {.name = "as it is", .reason = "Nothing is changed: what the others are to be held against."},

    {.name = "duplicate rows 1e-3", .reason = "Half of the rows nearly repeat the others, so their difference is mostly noise.", .response = {near_duplicates, 1e-3}},
    {.name = "duplicate rows 1e-6", .reason = "The differences of rows are near float32's own rounding.", .response = {near_duplicates, 1e-6}},
    {.name = "duplicate rows 1e-9", .reason = "The differences of rows are lost in float32, and squared they are lost in double.", .response = {near_duplicates, 1e-9}},
    {.name = "duplicate rows 1e-12", .reason = "The differences of rows are a few roundings of double.", .response = {near_duplicates, 1e-12}},
    {.name = "equal rows", .reason = "A A' is singular, and equal rows contradict each other by the noise.", .response = {near_duplicates, 0.0}},
    {.name = "rows across 1e3", .reason = "Weak rows weigh a millionth of strong ones in the objective.", .response = {row_spread, 1e3}},
    {.name = "rows across 1e6", .reason = "Squares of weak rows are below the rounding of strong ones' squares.", .response = {row_spread, 1e6}},
    {.name = "rows across 1e12", .reason = "Weak rows are below the rounding of strong ones even unsquared.", .response = {row_spread, 1e12}},
    {.name = "one row times 1e5", .reason = "One sample decides the size of every residual, and a step that suits it moves nothing else.", .response = {one_row, 1e5}},
    {.name = "rank one", .reason = "All rows say the same of the picture; all but one singular value are rounding.", .response = {rank_one, 0.0}},
    {.name = "rank one and a little", .reason = "The second singular value is 1e-5 of the first.", .response = {rank_one, 1e-5}},
    {.name = "raised by 100", .reason = "The mean stands ten thousand times above the details.", .response = {raised, 100.0}},
    {.name = "dense random rows", .reason = "Every row sees every pixel, and one mode, the mean, is far above a flat rest.", .response = {random_rows, 1.0}},
    {.name = "random rows of both signs", .reason = "Nothing of an eye is left that a start or a rule could lean on.", .response = {random_rows, 2.0}},
    {.name = "unit 1e-30", .reason = "Squares of the entries are below the smallest float32.", .response = {scaled, 1e-30}},
    {.name = "unit 1e30", .reason = "Squares of the entries are above the largest float32.", .response = {scaled, 1e30}},

    {.name = "blind rows", .reason = "A third of the ommatidia sees nothing and reads nought.", .response = {blinded, 1.0 / 3.0}},
    {.name = "unseen pixels", .reason = "No sample says anything about a quarter of the pixels.", .response = {unseen, 0.25}},
    {.name = "one row", .reason = "One sample for the whole picture.", .response = {first_row, 0.0}},
    {.name = "more rows than pixels", .reason = "Half as many rows again as pixels, all nearly repetitions.", .response = {tall, 1e-2}},

    {.name = "dark", .reason = "Every sample is nought, and the picture must be nought.", .samples = {all_times, 0.0}},
    {.name = "outlier 1e6", .reason = "One sample is a million times the others.", .samples = {one_outlier, 1e6}},
    {.name = "saturated", .reason = "Every sample above two fifths of the largest reads that.", .samples = {saturated, 0.4}},
    {.name = "dead channels unknown", .reason = "A tenth of the samples is nought where it should not be.", .samples = {dead_unknown, 0.1}},
    {.name = "hot channels unknown", .reason = "A tenth of the samples is ten times too large.", .samples = {hot_unknown, 0.1}},
    {.name = "dead channels known", .reason = "A tenth of the samples is NaN, and weighs nothing.", .samples = {dead_known, 0.1}},
    {.name = "SNR -10 dB", .reason = "The noise is three times the signal.", .snr_db = -10.0, .lambda_share = 0.1},
    {.name = "SNR 120 dB", .reason = "The samples are exact to float32's last bit, and lambda is as small.", .snr_db = 120.0, .lambda_share = 1e-6},
    {.name = "negative samples", .reason = "No picture of light explains them.", .samples = {all_times, -1.0}},
    {.name = "samples of no picture", .reason = "Noise alone, as large as the signal was.", .samples = {unrelated, 1.0}},
    {.name = "weights across 1e9", .reason = "A weight of 1e-9 in the same frame as one of 1.", .samples = {weight_spread, 1e-9}},

    {.name = "lambda 1e-12", .reason = "The penalty is far below the rounding of the fit.", .lambda_share = 1e-12},
    {.name = "lambda 1e-6", .reason = "The fit has to be nearly exact before the penalty says anything.", .lambda_share = 1e-6},
    {.name = "lambda half", .reason = "Nearly everything is shrunk away.", .lambda_share = 0.5},
    {.name = "lambda beyond", .reason = "The picture must be exactly nought.", .lambda_share = 1.01},
    {.name = "lambda 1e6", .reason = "The penalty is a million times what makes the picture nought.", .lambda_share = 1e6},
}};
// clang-format on

}  // namespace

std::span<const HardCase> hard_cases() noexcept {
  return cases;
}

}  // namespace compueye::firmware
