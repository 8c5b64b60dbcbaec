#pragma once

#include <string>
#include <utility>
#include <vector>

#include "tests/firmware/cli_run/program.hpp"
#include "tests/firmware/failure_check.hpp"

namespace compueye::test {

/// Runs `arguments` and --json, which must fail as said.
inline void check_refused(std::vector<std::string> arguments, hal::ErrorCode code, const std::string& place,
                          const Named& named) {
  arguments.emplace_back("--json");
  check_failed_json(compueye(arguments), code, place, named);
}

}  // namespace compueye::test
