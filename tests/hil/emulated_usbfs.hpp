#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <span>
#include <vector>

struct usbdevfs_urb;

/// Linux's side of a USB device file: what the kernel does with the ioctls that libusb makes, over a device that is a
/// model. For clients of this process, whose memory it reads and writes. After linux/usbdevice_fs.h and
/// drivers/usb/core/devio.c.
namespace compueye::hil {

/// The device at the other end of the cable. Calls come under the lock of one EmulatedUsbfs.
class UsbDeviceModel {
 public:
  struct Setup {
    std::uint8_t type = 0, request = 0;
    std::uint16_t value = 0, index = 0;
  };
  enum class Outcome : std::uint8_t { done, nothing, stalled, gone };
  struct Transfer {
    Outcome outcome = Outcome::nothing;
    std::size_t bytes = 0;
  };
  UsbDeviceModel() = default;
  UsbDeviceModel(const UsbDeviceModel&) = delete;
  UsbDeviceModel& operator=(const UsbDeviceModel&) = delete;
  virtual ~UsbDeviceModel() = default;

  /// `data` is the data stage: filled by a request towards the host, read by one towards the device.
  virtual Transfer control(const Setup& setup, std::span<std::byte> data) = 0;
  /// A bulk-in transfer: what is ready, up to the size of `into`.
  virtual Transfer read(std::span<std::byte> into) = 0;
  virtual void reset() = 0;
};

/// Thread-safe. One a plugging-in: a device that comes back has another file.
class EmulatedUsbfs {
 public:
  struct Answer {
    int result = 0;  ///< of ioctl(): 0 or more, or -1
    int error = 0;   ///< then errno
  };
  struct Counters {
    std::uint64_t submitted = 0, reaped = 0, discarded = 0, cleared_halts = 0, resets = 0;
    std::size_t most_waiting = 0;        ///< URBs that were under way at once
    std::size_t most_waiting_bytes = 0;  ///< and their buffers
  };

  explicit EmulatedUsbfs(UsbDeviceModel& device) : device_(device) {}

  Answer ioctl(unsigned long request, void* argument);

  /// The cable's own faults: the next bulk transfers end with these statuses (-EPROTO, -EOVERFLOW).
  void fail_next(int status, int count = 1);
  /// The next submissions are refused with `error`; 0: no more.
  void refuse_submissions(int error);
  /// Another program has the interface.
  void hold_interface(bool held);

  /// Whether reaping would return a URB now.
  [[nodiscard]] bool ready();
  [[nodiscard]] Counters counters();
  [[nodiscard]] std::size_t waiting();

 private:
  Answer submit(usbdevfs_urb& urb);
  Answer reap(void** where);
  Answer discard(usbdevfs_urb* urb);
  void give_back(usbdevfs_urb& urb, int status, std::size_t bytes);
  bool serve_control(usbdevfs_urb& urb);
  bool serve_bulk(usbdevfs_urb& urb);
  void serve();

  UsbDeviceModel& device_;
  std::mutex mutex_;
  std::deque<usbdevfs_urb*> waiting_, done_;
  std::deque<int> failures_;
  int submit_error_ = 0;
  bool held_ = false, gone_ = false;
  Counters counters_;
};

}  // namespace compueye::hil
