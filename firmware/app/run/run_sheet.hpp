#pragma once

#include <filesystem>

#include "firmware/app/run/run_report.hpp"
#include "hal/image.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// The contact sheet of a run: scene | conventional eye | reconstruction (the last delivered frame) | its error, with
/// their figures. An empty `conventional` picture is left out.
[[nodiscard]] hal::Result<void> write_run_sheet(const std::filesystem::path& path, const RunReport& report,
                                                const hal::Image& truth, const hal::Image& conventional,
                                                const hal::Image& last);

}  // namespace compueye::firmware
