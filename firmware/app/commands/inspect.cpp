#include "firmware/app/command.hpp"

namespace compueye::firmware {

void add_inspect_command(CLI::App&, Action&) {}

}  // namespace compueye::firmware
