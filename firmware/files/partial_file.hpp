#pragma once

#include <string>

#include "firmware/files/file_descriptor.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// A file under a name of its own, "<target>.<process>-<16 random digits>.partial", beside the one that it is to
/// become. It is locked (flock) as long as it is open, so that the partial files of processes that are dead can be told
/// from those of the living, and are removed: once for each folder and process, when the first is made there.
struct PartialFile {
  std::string path;
  FileDescriptor file;

  /// Errors: those of a file that cannot be made, told of `target`. Never opens what is there already, be it a link.
  [[nodiscard]] static hal::Result<PartialFile> create(const std::string& target);
};

/// It has got its name, or is gone: the process no longer removes it when it is left early.
void forget_partial(const std::string& path) noexcept;

/// Removes every partial file of this process, which is about to be left.
void remove_partials() noexcept;

/// Removes the partial files of dead processes in a folder: own ones only, and none that anybody holds.
void sweep_partials(const std::string& folder) noexcept;

}  // namespace compueye::firmware
