#pragma once

#include <filesystem>

#include "studies/comparison/comparison.hpp"

namespace compueye::firmware {

/// Scene, conventional eye and every contender's picture with its figures, a row of panels a basis, the best marked.
[[nodiscard]] hal::Result<void> write_compare_sheet(const std::filesystem::path& path, const Comparison& comparison);

}  // namespace compueye::firmware
