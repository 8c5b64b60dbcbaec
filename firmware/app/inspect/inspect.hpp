#pragma once

#include <string>

#include "firmware/app/session.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// The command line of `compueye inspect`.
struct InspectRequest {
  std::string what;         ///< a .npy or .mtx file, a board's folder or its board.toml
  std::string as = "auto";  ///< auto, array or response; for .npy
  std::string size;         ///< "HxW" of the picture behind a response; empty: unknown
};

/// `compueye inspect`: the key figures of a file or a board on stdout.
[[nodiscard]] hal::Result<void> inspect(const InspectRequest& request, Session& session);

}  // namespace compueye::firmware
