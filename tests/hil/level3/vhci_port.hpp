#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "hal/result.hpp"
#include "tests/hil/emulated_usbfs.hpp"

namespace compueye::hil {

/// A port of the kernel's virtual USB host controller (vhci-hcd, Documentation/usb/usbip_protocol.rst): what is plugged
/// in is a device at high speed that this process is.
class VhciPort {
 public:
  struct Settings {
    int port = 0;  ///< 0 to 7 are those of high speed
    std::vector<std::uint8_t> descriptors;
    std::function<std::unique_ptr<UsbDeviceModel>()> plugged;  ///< called at each plugging-in
    std::string controller = "/sys/devices/platform/vhci_hcd.0";
  };
  explicit VhciPort(Settings settings) : settings_(std::move(settings)) {}
  ~VhciPort() { unplug(); }
  VhciPort(const VhciPort&) = delete;
  VhciPort& operator=(const VhciPort&) = delete;

  /// Does nothing where it is plugged in. Errors: not_found (the module is not loaded), io (the port is taken).
  [[nodiscard]] hal::Result<void> plug();
  /// The kernel sees the cable pulled.
  void unplug();
  [[nodiscard]] bool plugged() const noexcept { return server_.joinable(); }

 private:
  Settings settings_;
  std::unique_ptr<UsbDeviceModel> device_;
  int socket_ = -1;
  std::atomic<bool> stopping_ = false;
  std::thread server_;
};

}  // namespace compueye::hil
