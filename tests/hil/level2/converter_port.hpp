#pragma once

#include <cstdint>
#include <string>

#include "drivers/frontend/emulated_front_end.hpp"
#include "tests/hil/converters_in_time.hpp"
#include "tests/hil/level2/gpio_port.hpp"
#include "tests/hil/level2/spi_port.hpp"

namespace compueye::hil {

/// Emulated converters on device files of spidev and a GPIO chip of the testbed, in real time. Line 0 is data-ready, 1
/// to 3 a chip's number, 4 reset.
class ConverterPort {
 public:
  ConverterPort(Testbed& testbed, frontend::EmulatedFrontEndSettings settings);
  ConverterPort(const ConverterPort&) = delete;
  ConverterPort& operator=(const ConverterPort&) = delete;

  void inject(const frontend::FrontEndFault& fault) { converters_.inject(fault); }
  [[nodiscard]] std::string data() const { return data_.path(); }
  [[nodiscard]] std::string settings() const { return settings_.path(); }
  [[nodiscard]] const std::string& gpiochip() const { return gpio_.name(); }

 private:
  GpioPort gpio_;
  ConvertersInTime converters_;
  SpiPort data_, settings_;
};

}  // namespace compueye::hil
