#pragma once

#include <string>

#include "tests/hil/emulated_usbfs.hpp"

namespace compueye::hil {

/// From now on, opening `path` in this process, by whatever library, opens `file`: the program defines open(), ioctl()
/// and close(), and hands everything else to what was loaded before it (umockdev, the C library). umockdev alone takes
/// a socket round trip for each ioctl and never lets poll() sleep. The program must be linked with -rdynamic.
void shim_usbfs(const std::string& path, EmulatedUsbfs& file);

/// Opening it fails with `error` from now on; 0: works again.
void refuse_to_open(int error);

/// Lets poll() see what time has brought; every ioctl does so too. For devices that have to wait for their data.
void refresh_shim();

}  // namespace compueye::hil
