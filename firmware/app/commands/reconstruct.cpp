#include "firmware/app/reconstruct/reconstruct.hpp"

#include <memory>

#include "firmware/app/command.hpp"

namespace compueye::firmware {
namespace {

Action declare(OptionList& options) {
  auto o = std::make_shared<ReconstructOptions>();
  add_reconstruct_options(options, *o);
  return action_of(o, reconstruct);
}

}  // namespace

extern const Command reconstruct_command;
const Command reconstruct_command{"reconstruct", "samples y and a response A become pictures x", OnSignal::gives_up,
                                  declare, reconstruct_footer};

}  // namespace compueye::firmware
