#pragma once

#include <memory>
#include <string>

#include "tests/hil/emulated_spidev.hpp"
#include "tests/hil/level2/testbed.hpp"

namespace compueye::hil {

/// A device file of spidev in the testbed, with a device behind it.
class SpiPort {
 public:
  SpiPort(Testbed& testbed, SpiDeviceModel& device);
  ~SpiPort();
  SpiPort(const SpiPort&) = delete;
  SpiPort& operator=(const SpiPort&) = delete;

  /// What the kernel's module says of itself in sysfs; without it there is no such file.
  void tell_bufsiz(std::size_t bytes);
  /// The controller's driver goes away, and the device file with it.
  void unbind();
  [[nodiscard]] std::string path() const { return node_.path(); }

  EmulatedSpidev file;

 private:
  Testbed& testbed_;
  DeviceFile node_;
  UMockdevIoctlBase* handler_;
};

}  // namespace compueye::hil
