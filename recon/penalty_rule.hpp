#pragma once

#include "recon/reconstructor.hpp"

namespace compueye::recon {

/// The ADMM penalty rho of a plan: plan.rho when given; lambda for tikhonov; otherwise by rule.
[[nodiscard]] double resolve_rho(const Response& response, const Objective& objective, const Plan& plan);

}  // namespace compueye::recon
