#pragma once

#include <span>

#include "recon/response.hpp"

namespace compueye::firmware {

/// The response of an eye with dead ommatidia (ascending numbers): a dead one tells nothing, and with an empty row
/// every solver leaves it out.
[[nodiscard]] recon::Response without_dead(const recon::Response& response, std::span<const int> dead);

}  // namespace compueye::firmware
