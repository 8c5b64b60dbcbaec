#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tests/hil/emulated_gpiochip.hpp"
#include "tests/hil/level2/testbed.hpp"

namespace compueye::hil {

/// A GPIO chip in the testbed: its device file, what libgpiod looks up in sysfs, and a device file for each request,
/// which a program cannot see.
class GpioPort {
 public:
  GpioPort(Testbed& testbed, std::vector<EmulatedGpiochip::Line> lines);
  ~GpioPort();
  GpioPort(const GpioPort&) = delete;
  GpioPort& operator=(const GpioPort&) = delete;

  [[nodiscard]] const std::string& name() const { return node_.name; }  ///< "gpiochip11"
  [[nodiscard]] std::string path() const { return node_.path(); }

 private:
  struct RequestFile;
  DeviceFile node_;
  std::vector<std::unique_ptr<RequestFile>> files_;

 public:
  EmulatedGpiochip chip;

 private:
  UMockdevIoctlBase* handler_;
};

}  // namespace compueye::hil
