#include "tests/hil/emulated_usbfs.hpp"

#include <linux/usb/ch9.h>
#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace compueye::hil {
namespace {

constexpr std::size_t setup_bytes = 8;
constexpr int high_speed = USB_SPEED_HIGH;

std::uint16_t little_u16(const std::byte* at) {
  return static_cast<std::uint16_t>(std::to_integer<unsigned>(at[0]) | std::to_integer<unsigned>(at[1]) << 8U);
}

/// A URB's status for an outcome that ends it.
int status_of(UsbDeviceModel::Outcome outcome) {
  switch (outcome) {
    case UsbDeviceModel::Outcome::stalled:
      return -EPIPE;
    case UsbDeviceModel::Outcome::gone:
      return -ESHUTDOWN;
    default:
      return 0;
  }
}

}  // namespace

EmulatedUsbfs::Answer EmulatedUsbfs::ioctl(unsigned long request, void* argument) {
  const std::lock_guard lock(mutex_);
  // Linux hands out what was under way even after the device has gone.
  if (request == USBDEVFS_REAPURBNDELAY) return reap(static_cast<void**>(argument));
  if (gone_) return {-1, ENODEV};
  switch (request) {
    case USBDEVFS_GET_CAPABILITIES:
      // Those of a host controller for high speed: a transfer of any size is one URB.
      *static_cast<std::uint32_t*>(argument) = USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_BULK_CONTINUATION |
                                               USBDEVFS_CAP_NO_PACKET_SIZE_LIM | USBDEVFS_CAP_BULK_SCATTER_GATHER |
                                               USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
      return {};
    case USBDEVFS_GET_SPEED:
      return {high_speed, 0};
    case USBDEVFS_CLAIMINTERFACE:
    case USBDEVFS_DISCONNECT_CLAIM:
      return held_ ? Answer{-1, EBUSY} : Answer{};
    case USBDEVFS_RELEASEINTERFACE:
    case USBDEVFS_SETCONFIGURATION:
    case USBDEVFS_SETINTERFACE:
      return {};
    case USBDEVFS_GETDRIVER:
      return {-1, ENODATA};
    case USBDEVFS_CLEAR_HALT:
      ++counters_.cleared_halts;
      return {};
    case USBDEVFS_RESET:
      ++counters_.resets;
      device_.reset();
      return {};
    case USBDEVFS_SUBMITURB:
      return submit(*static_cast<usbdevfs_urb*>(argument));
    case USBDEVFS_DISCARDURB:
      return discard(static_cast<usbdevfs_urb*>(argument));
    default:
      return {-1, ENOTTY};
  }
}

EmulatedUsbfs::Answer EmulatedUsbfs::submit(usbdevfs_urb& urb) {
  if (submit_error_ != 0 && urb.type == USBDEVFS_URB_TYPE_BULK) return {-1, submit_error_};
  urb.status = -EINPROGRESS;
  urb.actual_length = 0;
  waiting_.push_back(&urb);
  ++counters_.submitted;
  std::size_t bytes = 0;
  for (const usbdevfs_urb* each : waiting_) bytes += static_cast<std::size_t>(each->buffer_length);
  counters_.most_waiting = std::max(counters_.most_waiting, waiting_.size());
  counters_.most_waiting_bytes = std::max(counters_.most_waiting_bytes, bytes);
  return {};
}

EmulatedUsbfs::Answer EmulatedUsbfs::discard(usbdevfs_urb* urb) {
  const auto found = std::find(waiting_.begin(), waiting_.end(), urb);
  if (found == waiting_.end()) return {-1, EINVAL};
  waiting_.erase(found);
  ++counters_.discarded;
  give_back(*urb, -ENOENT, 0);
  return {};
}

EmulatedUsbfs::Answer EmulatedUsbfs::reap(void** where) {
  serve();
  if (done_.empty()) return {-1, gone_ ? ENODEV : EAGAIN};
  *where = done_.front();
  done_.pop_front();
  ++counters_.reaped;
  return {};
}

void EmulatedUsbfs::give_back(usbdevfs_urb& urb, int status, std::size_t bytes) {
  urb.status = status;
  urb.actual_length = static_cast<int>(bytes);
  if (status == -ESHUTDOWN) gone_ = true;
  done_.push_back(&urb);
}

/// Carries out what waits, endpoint by endpoint in order, as far as the device lets it.
void EmulatedUsbfs::serve() {
  bool bulk_blocked = false;
  for (std::size_t k = 0; k < waiting_.size();) {
    usbdevfs_urb& urb = *waiting_[k];
    const bool bulk = urb.type == USBDEVFS_URB_TYPE_BULK;
    const bool over = bulk ? !bulk_blocked && serve_bulk(urb) : serve_control(urb);
    if (over) {
      waiting_.erase(waiting_.begin() + static_cast<std::ptrdiff_t>(k));
      // A halted endpoint stays where it is; the transfers behind it wait.
      bulk_blocked = bulk_blocked || urb.status == -EPIPE;
    } else {
      bulk_blocked = bulk_blocked || bulk;
      ++k;
    }
  }
}

bool EmulatedUsbfs::serve_control(usbdevfs_urb& urb) {
  const auto* setup = static_cast<const std::byte*>(urb.buffer);
  const UsbDeviceModel::Setup request{std::to_integer<std::uint8_t>(setup[0]), std::to_integer<std::uint8_t>(setup[1]),
                                      little_u16(setup + 2), little_u16(setup + 4)};
  const std::span data(static_cast<std::byte*>(urb.buffer) + setup_bytes, little_u16(setup + 6));
  const auto transfer = device_.control(request, data);
  if (transfer.outcome == UsbDeviceModel::Outcome::nothing) return false;
  give_back(urb, status_of(transfer.outcome), transfer.bytes);
  return true;
}

bool EmulatedUsbfs::serve_bulk(usbdevfs_urb& urb) {
  if (!failures_.empty()) {
    const int status = failures_.front();
    failures_.pop_front();
    give_back(urb, status, 0);
    return true;
  }
  const auto transfer =
      device_.read({static_cast<std::byte*>(urb.buffer), static_cast<std::size_t>(urb.buffer_length)});
  if (transfer.outcome == UsbDeviceModel::Outcome::nothing) return false;
  give_back(urb, status_of(transfer.outcome), transfer.bytes);
  return true;
}

void EmulatedUsbfs::fail_next(int status, int count) {
  const std::lock_guard lock(mutex_);
  for (int k = 0; k < count; ++k) failures_.push_back(status);
}

void EmulatedUsbfs::refuse_submissions(int error) {
  const std::lock_guard lock(mutex_);
  submit_error_ = error;
}

void EmulatedUsbfs::hold_interface(bool held) {
  const std::lock_guard lock(mutex_);
  held_ = held;
}

bool EmulatedUsbfs::ready() {
  const std::lock_guard lock(mutex_);
  serve();
  return !done_.empty();
}

EmulatedUsbfs::Counters EmulatedUsbfs::counters() {
  const std::lock_guard lock(mutex_);
  return counters_;
}

std::size_t EmulatedUsbfs::waiting() {
  const std::lock_guard lock(mutex_);
  return waiting_.size();
}

}  // namespace compueye::hil
