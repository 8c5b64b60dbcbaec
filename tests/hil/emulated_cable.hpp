#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "drivers/protocol/device_emulator.hpp"
#include "hal/clock.hpp"
#include "tests/drivers/protocol/small_host.hpp"
#include "tests/hil/emulated_usbfs.hpp"

namespace compueye::hil {

/// The emulated eye for the threads of a test and of the operating system's side. The device's time goes with real
/// time, but only as fast as it is looked at: a machine too busy to run the host slows the device down as well, instead
/// of filling its memory meanwhile.
class EmulatedCable {
 public:
  explicit EmulatedCable(const protocol::EmulatorSettings& settings)
      : EmulatedCable(settings, protocol::tests::shown(settings.descriptor.bits), 2'000'000) {}
  /// `most_between_looks_ns`: of the device's time. One that must not be slow, whatever it loses, is given seconds.
  EmulatedCable(const protocol::EmulatorSettings& settings, protocol::SampleGenerator samples,
                std::int64_t most_between_looks_ns)
      : most_between_looks_ns_(most_between_looks_ns),
        device_(protocol::DeviceEmulator::create(settings, std::move(samples), now_ns_).value()) {}

  /// Calls use(device, now_ns) alone.
  template <class Use>
  auto with(Use&& use) {
    const std::lock_guard lock(mutex_);
    const std::int64_t real_ns = clock_.now_ns();
    now_ns_ += std::min(real_ns - looked_ns_, most_between_looks_ns_);
    looked_ns_ = real_ns;
    return use(device_, now_ns_);
  }
  /// So much of the device's time passes now, while nobody reads.
  void pass(std::int64_t device_ns) {
    const std::lock_guard lock(mutex_);
    now_ns_ += device_ns;
  }
  void inject(protocol::EmulatorFault fault) {
    with([&](protocol::DeviceEmulator& device, std::int64_t now_ns) {
      if (!fault.at_frame) fault.at_ns = now_ns;
      device.inject(std::move(fault));
      return device.attached(now_ns);  // so that it has happened
    });
  }
  /// Takes the eye away and has it back at once, powered off and on: files opened before are dead. With another
  /// `serial`, it is another eye.
  void replace(const std::string& serial) {
    const bool same = with([&](auto& device, auto) { return device.serial() == serial; });
    inject({.kind = same ? protocol::FaultKind::unplug : protocol::FaultKind::replug_other,
            .duration_ns = 1,
            .text = serial});
    // Whoever asks next finds the one that is back, whether or not anybody has looked since.
    pass(1);
    static_cast<void>(attachment());
  }
  [[nodiscard]] std::uint64_t attachment() {
    return with([](auto& device, std::int64_t now_ns) { return device.attachment(now_ns); });
  }
  [[nodiscard]] std::string serial() {
    return with([](auto& device, std::int64_t) { return device.serial(); });
  }

 private:
  const std::int64_t most_between_looks_ns_;
  hal::MonotonicClock clock_;
  std::mutex mutex_;
  std::int64_t looked_ns_ = clock_.now_ns();
  std::int64_t now_ns_ = looked_ns_;
  protocol::DeviceEmulator device_;
};

/// One plugging-in of the emulated eye as a USB device.
class EmulatedUsbEye final : public UsbDeviceModel {
 public:
  explicit EmulatedUsbEye(EmulatedCable& cable) : cable_(cable), attachment_(cable.attachment()) {}

  Transfer control(const Setup& setup, std::span<std::byte> data) override;
  Transfer read(std::span<std::byte> into) override;
  void reset() override;
  std::function<void()> at_reset;  ///< the host resets the bus when it opens the eye

 private:
  Transfer standard(const Setup& setup, std::span<std::byte> data);
  template <class Use>
  Transfer when_there(Use&& use);

  EmulatedCable& cable_;
  std::uint64_t attachment_;
};

[[nodiscard]] UsbDeviceModel::Transfer usb_transfer_of(protocol::DeviceEmulator::Transfer transfer);

/// String descriptor `index` of an eye, empty where it has none: 2 its product, 3 its serial.
[[nodiscard]] std::vector<std::uint8_t> usb_string_descriptor(unsigned index, const std::string& serial);

/// Device, configuration, interface and endpoint descriptor as they lie in sysfs.
[[nodiscard]] std::vector<std::uint8_t> usb_descriptors(std::uint16_t vendor, std::uint16_t product);

}  // namespace compueye::hil
