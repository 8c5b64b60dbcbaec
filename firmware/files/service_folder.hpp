#pragma once

#include <string>

namespace compueye::firmware {

/// What systemd tells a service in `variable`, STATE_DIRECTORY or CACHE_DIRECTORY (systemd.exec(5)): a folder of its
/// own, the first where there are several. Empty when nothing, or no absolute path, is told.
[[nodiscard]] std::string service_folder(const char* variable);

}  // namespace compueye::firmware
