#include "firmware/app/inspect/inspect.hpp"

#include <memory>

#include "firmware/app/command.hpp"
#include "firmware/app/options/json_failure.hpp"
#include "firmware/app/options/option_checks.hpp"
#include "firmware/app/options/value_text.hpp"

namespace compueye::firmware {

void add_inspect_command(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<InspectOptions>();
  CLI::App* command = app.add_subcommand("inspect", "the key figures of a response, of samples, pictures or a board");
  command->add_option("what", options->what, "a .npy or .mtx file, or the folder of a board")
      ->required()
      ->type_name("FILE");
  command
      ->add_option("--size", options->size,
                   "rows and columns of the picture behind a response: adds mirror symmetry and the memory of admm")
      ->type_name("HxW")
      ->check(text_where([](const std::string& text) {
        return picture_size_from(text) ? std::string() : "is '" + text + "', expected rows and columns such as 16x16";
      }));
  command
      ->add_option("--as", options->as,
                   "how to take a .npy: array (any), response (two axes, all finite), or auto (default): the figures "
                   "of a response are added where they make sense")
      ->type_name("KIND")
      ->check(one_of({"auto", "array", "response"}, {}));
  command->add_flag("--json", options->json, "print one object with every figure");
  command->footer(
      "The largest singular value comes from power iteration on A'A, at most 300 times. A board's figures hold its "
      "noise, LSB,\nlambda and rho by rule, and the factors kept beside it.\n"
      "Exit codes: 0 done, 1 failed, 2 wrong usage.\n\n"
      "Examples:\n"
      "  compueye inspect A.mtx --size 16x16\n"
      "  compueye inspect y.npy --as array\n"
      "  compueye inspect boards/sim-8x8 --json");
  command->callback(
      [options, &chosen] { chosen = [options] { return with_json_failure(options->json, inspect(*options)); }; });
}

}  // namespace compueye::firmware
