#pragma once

#include "firmware/app/reconstruct/reconstruct_options.hpp"
#include "firmware/app/session.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// `compueye reconstruct`: samples from a file become pictures in files, and a report on stdout. Either every output
/// appears or none.
[[nodiscard]] hal::Result<void> reconstruct(const ReconstructOptions& options, Session& session);

}  // namespace compueye::firmware
