#pragma once

#include <string>
#include <string_view>

#include "hal/error.hpp"

namespace compueye::transport {

/// A libusb error code (LIBUSB_ERROR_...) as an error that says what to do. `place`: bus address or serial. `doing`:
/// "opening the device".
[[nodiscard]] hal::Error usb_error(int code, std::string place, std::string_view doing);

}  // namespace compueye::transport
