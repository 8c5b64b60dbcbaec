#pragma once

#include <string>

#include "firmware/files/file_descriptor.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// The folder of one run's pictures, so that those of two never mix: it holds none when it is claimed, and nobody else
/// can claim it meanwhile.
class PictureFolder {
 public:
  /// The file beside the pictures that says which frames they are.
  static constexpr const char* frame_list = "frames.csv";

  /// Makes the folder when it is missing, and removes what a run that was killed left half-written in it. Errors: io
  /// when pictures of an earlier run are there, or another run is at work in it (where the file system can tell);
  /// otherwise those of a folder that cannot be made or written.
  [[nodiscard]] static hal::Result<PictureFolder> claim(const std::string& folder);

 private:
  FileDescriptor lock_;
};

}  // namespace compueye::firmware
