#include "drivers/device/stream_reader.hpp"

#include "drivers/device/stream_reader_hid.hpp"
#include "drivers/device/stream_reader_usb.hpp"

namespace compueye::device {

std::unique_ptr<StreamReader> make_stream_reader(DeviceBus bus, const protocol::DeviceDescriptor& descriptor) {
  if (bus == DeviceBus::hid) return std::make_unique<StreamReaderHid>(descriptor);
  return std::make_unique<StreamReaderUsb>(descriptor);
}

}  // namespace compueye::device
