#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "tests/hil/emulated_usbfs.hpp"
#include "tests/hil/level3/usbip_messages.hpp"

namespace compueye::hil {

/// The far end of a USB/IP connection: a device with one IN endpoint that is a model, and of chapter 9 of USB 2.0 what
/// a host asks of any device.
class UsbipDevice {
 public:
  /// `descriptors`: of the device, then its configuration. `socket` is a stream's, and remains its owner's.
  UsbipDevice(UsbDeviceModel& model, std::vector<std::uint8_t> descriptors, int socket)
      : model_(model), descriptors_(std::move(descriptors)), socket_(socket) {}

  /// Takes what the host asks, waits up to `patience_ms` for it, and answers what can be answered now. False when the
  /// host or the device has gone, or the host says what no host says.
  [[nodiscard]] bool serve(int patience_ms);
  /// Requests without an answer yet.
  [[nodiscard]] std::size_t waiting() const noexcept { return waiting_.size(); }

 private:
  struct Waiting {
    UsbipRequest request;
    std::vector<std::byte> data;
  };
  [[nodiscard]] bool take();
  [[nodiscard]] bool unlink(const UsbipRequest& request);
  [[nodiscard]] bool answer_waiting();
  [[nodiscard]] bool answer(const Waiting& each, UsbDeviceModel::Transfer transfer);
  [[nodiscard]] UsbDeviceModel::Transfer control(Waiting& each);
  [[nodiscard]] UsbDeviceModel::Transfer descriptor(unsigned kind, std::span<std::byte> data) const;

  UsbDeviceModel& model_;
  std::vector<std::uint8_t> descriptors_;
  int socket_;
  std::deque<Waiting> waiting_;
};

}  // namespace compueye::hil
