#pragma once

#include "recon/option_names.hpp"

namespace compueye::firmware {

// The words of board.toml and of the command line are recon's own.
using recon::basis_names;
using recon::constraint_names;
using recon::name;
using recon::Named;
using recon::operator_names;
using recon::solver_names;

}  // namespace compueye::firmware
