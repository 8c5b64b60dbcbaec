#include "firmware/app/command.hpp"

namespace compueye::firmware {

void add_response_command(CLI::App&, Action&) {}

}  // namespace compueye::firmware
