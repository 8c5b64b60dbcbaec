#pragma once

#include <sys/stat.h>

#include <optional>
#include <string>

#include "hal/result.hpp"

namespace compueye::firmware {

/// The stream of this process that a name means: "-" and "/dev/stdout" are 1, "/dev/stderr" 2, "/dev/fd/N" and
/// "/proc/self/fd/N" N. By the name alone, so that it works without /proc, and so that a file behind standard output
/// gets bytes and is not replaced.
[[nodiscard]] std::optional<int> named_stream(const std::string& name) noexcept;

/// Where an output goes.
struct OutputTarget {
  std::string path;                    ///< behind every symbolic link
  std::optional<struct stat> present;  ///< of what is there already
};

/// Where `name` leads; the file behind a link need not exist. Errors: io when a link on the way was made by somebody
/// else in a folder that is not theirs (a planted one), when links lead in a circle or the name is that of a folder;
/// and when what is there is a file that replacing would do wrong to: one that is read-only, is somebody else's, or has
/// another name (hard link) that would keep the old bytes.
[[nodiscard]] hal::Result<OutputTarget> output_target(const std::string& name);

}  // namespace compueye::firmware
