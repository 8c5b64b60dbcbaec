#pragma once

#include <cstdint>
#include <vector>

#include "tests/hil/emulated_cable.hpp"

namespace compueye::hil {

/// One plugging-in of the emulated eye as a HID device, as the kernel's usbhid sees it.
class EmulatedHidEye final : public UsbDeviceModel {
 public:
  explicit EmulatedHidEye(EmulatedCable& cable) : cable_(cable), attachment_(cable.attachment()) {}

  Transfer control(const Setup& setup, std::span<std::byte> data) override;
  Transfer read(std::span<std::byte> into) override;
  void reset() override;

 private:
  Transfer descriptor(const Setup& setup, std::span<std::byte> data);
  template <class Use>
  Transfer when_there(Use&& use);

  EmulatedCable& cable_;
  std::uint64_t attachment_;
};

/// Device, configuration, interface, HID and endpoint descriptor.
[[nodiscard]] std::vector<std::uint8_t> hid_descriptors(std::uint16_t vendor, std::uint16_t product);

}  // namespace compueye::hil
