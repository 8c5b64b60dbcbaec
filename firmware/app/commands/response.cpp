#include <memory>

#include "firmware/app/command.hpp"
#include "firmware/app/options/json_failure.hpp"
#include "firmware/app/options/option_checks.hpp"
#include "firmware/app/response/write_nominal.hpp"

namespace compueye::firmware {

void add_response_command(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<ResponseOptions>();
  CLI::App* command = app.add_subcommand("response", "the response A that a board's geometry gives");
  command->add_option("--board", options->board, "folder of the board, such as boards/sim-8x8")
      ->required()
      ->type_name("DIR");
  command
      ->add_option("--out", options->out,
                   "A as .mtx (sparse, exact) or .npy (dense float32, at most 1 GiB); without it only the figures")
      ->type_name("FILE");
  command
      ->add_option("--distance", options->distance_mm, "of the object plane from the lens tip (default: the board's)")
      ->type_name("MM")
      ->check(number_where([](double v) { return v > 0.0; }, "a finite number of mm above 0"));
  command
      ->add_option("--as-measured", options->as_measured,
                   "not as drawn but as a calibration of a built eye might find it, see below; same seed, same eye")
      ->type_name("SEED");
  command->add_flag("--json", options->json, "print one object with every figure");
  command->footer(
      "a_mj is the share of pixel j, 0 to 1, that the cone of ommatidium m covers on the object plane. .eye files come "
      "later.\n--as-measured tilts every axis (0.05 deg std), spreads gains (2 %), softens the edge of every field "
      "(over "
      "30 % of the\nhalf angle) and makes its sensitivity uneven (3 % rms), so rows are neither binary nor mirror "
      "images "
      "of each other.\nCtrl-C leaves no file behind. Exit codes: 0 done, 1 failed, 2 wrong usage.\n\n"
      "Examples:\n"
      "  compueye response --board boards/sim-8x8 --out A.mtx\n"
      "  compueye response --board boards/sim-80x80 --distance 12 --json\n"
      "  compueye response --board boards/sim-8x8 --as-measured 1 --out measured.mtx");
  command->callback(
      [options, &chosen] { chosen = [options] { return with_json_failure(options->json, write_nominal(*options)); }; });
}

}  // namespace compueye::firmware
