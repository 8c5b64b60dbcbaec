#include "tests/hil/level3/vhci_port.hpp"

#include <fcntl.h>
#include <linux/usb/ch9.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>

#include "tests/hil/level3/usbip_device.hpp"

namespace compueye::hil {
namespace {

constexpr int look_every_ms = 1;  // a device is asked so often for what nobody told it to wait for
constexpr int attach_tries = 100;
constexpr auto attach_pause = std::chrono::milliseconds(20);

/// "PORT SOCKET DEVICE SPEED" to the controller; an error number, or 0.
int attach(const std::string& controller, int port, int socket) {
  const int file = ::open((controller + "/attach").c_str(), O_WRONLY | O_CLOEXEC);
  if (file < 0) return errno;
  const std::string line = std::to_string(port) + " " + std::to_string(socket) + " " + std::to_string(port + 1) + " " +
                           std::to_string(USB_SPEED_HIGH);
  const int error = ::write(file, line.data(), line.size()) < 0 ? errno : 0;
  ::close(file);
  return error;
}

}  // namespace

hal::Result<void> VhciPort::plug() {
  if (plugged()) return {};
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    return hal::fail(hal::ErrorCode::io, settings_.controller, std::string("no socket: ") + std::strerror(errno));
  }
  int error = EBUSY;
  // The kernel frees a port some time after its device has gone.
  for (int k = 0; k < attach_tries && error == EBUSY; ++k) {
    if (k > 0) std::this_thread::sleep_for(attach_pause);
    error = attach(settings_.controller, settings_.port, ends[1]);
  }
  ::close(ends[1]);  // the kernel has its own
  if (error != 0) {
    ::close(ends[0]);
    return hal::fail(error == ENOENT ? hal::ErrorCode::not_found : hal::ErrorCode::io, settings_.controller,
                     "does not attach port " + std::to_string(settings_.port) + ": " + std::strerror(error) +
                         "; load the module vhci-hcd and run this as root");
  }
  socket_ = ends[0];
  stopping_ = false;
  device_ = settings_.plugged();
  server_ = std::thread([this] {
    UsbipDevice device(*device_, settings_.descriptors, socket_);
    while (!stopping_ && device.serve(look_every_ms)) {
    }
    ::shutdown(socket_, SHUT_RDWR);  // a device that has gone by itself is pulled, too
  });
  return {};
}

void VhciPort::unplug() {
  if (!plugged()) return;
  stopping_ = true;
  server_.join();
  ::close(socket_);
  socket_ = -1;
}

}  // namespace compueye::hil
