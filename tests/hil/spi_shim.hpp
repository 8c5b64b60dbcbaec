#pragma once

#include <string>

#include "tests/hil/emulated_spidev.hpp"

namespace compueye::hil {

/// From now on, opening `path` in this process opens `file`: the program defines open(), ioctl() and close(), and hands
/// everything else to what was loaded before it. Needs no umockdev, which takes a socket round trip for each ioctl. The
/// program must be linked with -rdynamic.
void shim_spidev(const std::string& path, EmulatedSpidev& file);

/// Opening it fails with `error` from now on; 0: works again.
void refuse_spidev(int error);

/// How many files of it are open.
[[nodiscard]] int open_spidev_files();

}  // namespace compueye::hil
