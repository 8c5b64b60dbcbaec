#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "drivers/frontend/emulated_front_end.hpp"
#include "hal/clock.hpp"
#include "tests/hil/level2/gpio_port.hpp"
#include "tests/hil/level2/spi_port.hpp"

namespace compueye::hil {

/// Emulated converters on device files of spidev and a GPIO chip of the testbed, in real time. Line 0 is data-ready, 1
/// to 3 a chip's number, 4 reset.
class ConverterPort {
 public:
  ConverterPort(Testbed& testbed, frontend::EmulatedFrontEndSettings settings);
  ~ConverterPort();
  ConverterPort(const ConverterPort&) = delete;
  ConverterPort& operator=(const ConverterPort&) = delete;

  void inject(frontend::FrontEndFault fault);
  [[nodiscard]] std::string data() const { return data_.path(); }
  [[nodiscard]] std::string settings() const { return settings_.path(); }
  [[nodiscard]] const std::string& gpiochip() const { return gpio_.name(); }

 private:
  /// One of the two buses.
  struct Bus final : SpiDeviceModel {
    Bus(ConverterPort& port, bool of_settings) : of(port), settings(of_settings) {}
    void transfer(std::span<const hal::SpiSegment> segments) override;
    [[nodiscard]] int status() override;
    ConverterPort& of;
    bool settings;
  };
  void pass_edges();

  hal::MonotonicClock clock_;
  std::mutex mutex_;
  frontend::EmulatedFrontEnd front_end_;
  Bus data_bus_{*this, false}, settings_bus_{*this, true};
  SpiPort data_, settings_;
  GpioPort gpio_;
  std::atomic<bool> stopping_ = false;
  std::thread edges_;
};

}  // namespace compueye::hil
