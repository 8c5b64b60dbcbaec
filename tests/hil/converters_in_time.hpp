#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>

#include "drivers/frontend/emulated_front_end.hpp"
#include "hal/clock.hpp"
#include "tests/hil/emulated_spidev.hpp"

namespace compueye::hil {

/// Emulated converters in real time, for the threads of a test and of the operating system's side: their two buses, and
/// their data-ready line.
class ConvertersInTime {
 public:
  /// `at_edge` is told when the line fell, by a thread that may be late.
  ConvertersInTime(frontend::EmulatedFrontEndSettings settings, std::function<void(std::int64_t t_ns)> at_edge);
  ~ConvertersInTime();
  ConvertersInTime(const ConvertersInTime&) = delete;
  ConvertersInTime& operator=(const ConvertersInTime&) = delete;

  void inject(frontend::FrontEndFault fault);
  void select(std::uint32_t chip);
  void reset_level(bool high);
  [[nodiscard]] SpiDeviceModel& data() noexcept { return data_; }
  [[nodiscard]] SpiDeviceModel& settings() noexcept { return settings_; }
  /// Called before each exchange of data, where set: to look at lines that nobody tells of.
  std::function<void()> before_exchange;

 private:
  /// One of the two buses.
  struct Bus final : SpiDeviceModel {
    Bus(ConvertersInTime& converters, bool of_settings) : of(converters), settings(of_settings) {}
    void transfer(std::span<const hal::SpiSegment> segments) override;
    [[nodiscard]] int status() override;
    [[nodiscard]] int outcome() override { return outcome_; }
    ConvertersInTime& of;
    bool settings;

   private:
    int outcome_ = 0;
  };
  void pass_edges();

  hal::MonotonicClock clock_;
  std::mutex mutex_;
  frontend::EmulatedFrontEnd front_end_;
  std::function<void(std::int64_t)> at_edge_;
  Bus data_{*this, false}, settings_{*this, true};
  std::atomic<bool> stopping_ = false;
  std::thread edges_;
};

}  // namespace compueye::hil
