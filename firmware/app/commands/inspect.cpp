#include "firmware/app/inspect/inspect.hpp"

#include <memory>

#include "firmware/app/command.hpp"

namespace compueye::firmware {
namespace {

Action declare(OptionList& options) {
  auto o = std::make_shared<InspectRequest>();
  options.add("what", o->what, "a .npy or .mtx file, or the folder of a board").required().type("FILE");
  options
      .add("--size", o->size,
           "rows and columns of the picture behind a response: adds mirror symmetry and the memory of admm")
      .type("HxW")
      .where(picture_size());
  options
      .add("--as", o->as,
           "how to take a .npy: array (any), response (two axes, all finite), or auto (default): the figures of a "
           "response are added where they make sense")
      .type("KIND")
      .where(one_of({"auto", "array", "response"}));
  options.json("print one object with every figure");
  return action_of(o, inspect);
}

std::string footer() {
  return "The largest singular value comes from power iteration on A'A, at most 300 times. A board's figures hold its "
         "noise, LSB,\nlambda and rho by rule, and the factors kept beside it.\n"
         "Exit codes: 0 done, 1 failed, 2 wrong usage.\n\n"
         "Examples:\n"
         "  compueye inspect A.mtx --size 16x16\n"
         "  compueye inspect y.npy --as array\n"
         "  compueye inspect boards/sim-8x8 --json";
}

}  // namespace

extern const Command inspect_command;
const Command inspect_command{"inspect", "the key figures of a response, of samples, pictures or a board",
                              OnSignal::gives_up, declare, footer};

}  // namespace compueye::firmware
