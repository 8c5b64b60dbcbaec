#include "firmware/app/command.hpp"

namespace compueye::firmware {

void add_run_command(CLI::App&, Action&) {}

}  // namespace compueye::firmware
