#pragma once

#include <cstdint>
#include <filesystem>

#include "hal/eye_geometry.hpp"
#include "recon/reconstructor.hpp"

namespace compueye::firmware {

/// recon::median_atom_norm() of a response whose content_hash() is `response_hash`, from
/// "<folder>/atom-norm-<hash>.txt" where that holds it, else computed and kept there. A file that does not fit or is
/// damaged is replaced; one that cannot be written is let be, since it only costs the next run some seconds.
[[nodiscard]] double kept_atom_norm(const std::filesystem::path& folder, const recon::Response& response,
                                    std::uint64_t response_hash, const hal::ObjectPlane& object,
                                    recon::BasisKind basis);

}  // namespace compueye::firmware
