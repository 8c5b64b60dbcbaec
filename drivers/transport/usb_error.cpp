#include "drivers/transport/usb_error.hpp"

#include <libusb-1.0/libusb.h>

#include <utility>

namespace compueye::transport {

hal::Error usb_error(int code, std::string place, std::string_view doing) {
  std::string sentence = std::string(doing) + ": ";
  const auto error = [&](hal::ErrorCode kind, std::string_view advice) {
    return hal::Error{kind, std::move(place), sentence.append(advice)};
  };
  switch (code) {
    case LIBUSB_ERROR_ACCESS:
      return error(hal::ErrorCode::io, "permission denied; install boards/60-compueye.rules and plug the eye in again");
    case LIBUSB_ERROR_BUSY:
      return error(hal::ErrorCode::io, "another program has the eye; close it");
    case LIBUSB_ERROR_NO_DEVICE:
    case LIBUSB_ERROR_NOT_FOUND:
      return error(hal::ErrorCode::disconnected, "the eye was unplugged; plug it in again");
    case LIBUSB_ERROR_NO_MEM:
      return error(hal::ErrorCode::no_space,
                   "the kernel has no memory for so many transfers; lower transfers or transfer_bytes, or raise "
                   "/sys/module/usbcore/parameters/usbfs_memory_mb");
    case LIBUSB_ERROR_TIMEOUT:
      return error(hal::ErrorCode::timeout, "no answer in time");
    case LIBUSB_ERROR_PIPE:
      return error(hal::ErrorCode::io, "the eye refused it (stall); STATUS says why");
    case LIBUSB_ERROR_OVERFLOW:
      return error(hal::ErrorCode::io, "the eye sent more than was asked for; open it again");
    default:
      sentence += libusb_error_name(code);
      return error(hal::ErrorCode::io, "; check the cable and open the eye again");
  }
}

}  // namespace compueye::transport
