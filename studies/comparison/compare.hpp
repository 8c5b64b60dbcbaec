#pragma once

#include "hal/result.hpp"
#include "studies/comparison/compare_options.hpp"

namespace compueye::firmware {

/// `compueye compare`: one frame of samples solved in every way, as a table and a contact sheet. Ctrl-C keeps what was
/// measured: it is printed and written, and the command succeeds when there is any.
[[nodiscard]] hal::Result<void> compare(const CompareOptions& options);

}  // namespace compueye::firmware
