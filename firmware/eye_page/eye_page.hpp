#pragma once

#include <string>

#include "firmware/eye_page/sections/page_data.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// One HTML page of everything that an eye file holds: complete in itself (its plots are SVG in it, its pictures data
/// URIs; no scripts, no fonts from elsewhere), light, and made to be printed in grey as well. Whatever words the file
/// holds are text on it. Errors: those of the page's sections.
[[nodiscard]] hal::Result<std::string> eye_page(const PageData& data);

}  // namespace compueye::firmware
