#pragma once

#include <string>

namespace compueye::firmware {

/// Where what takes long to make is kept for the board in `folder`: `.cache` there when this user can write it, else a
/// folder a board below CACHE_DIRECTORY (of a service of systemd), XDG_CACHE_HOME/compueye or ~/.cache/compueye (XDG
/// Base Directory Specification), so that a board which root has installed is not set up anew at every start. Without
/// any it is the board's, and keeping fails with a note.
[[nodiscard]] std::string cache_folder(const std::string& folder);

}  // namespace compueye::firmware
