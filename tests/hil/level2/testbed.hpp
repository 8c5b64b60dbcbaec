#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tests/hil/emulated_cable.hpp"
#include "tests/hil/umockdev_entries.hpp"

// GLib's types, without its headers.
extern "C" {
typedef struct _UMockdevTestbed UMockdevTestbed;
typedef struct _UMockdevIoctlBase UMockdevIoctlBase;
typedef struct _UMockdevIoctlClient UMockdevIoctlClient;
}

namespace compueye::hil {

/// "/dev/spidev1.0" of a subsystem.
struct DeviceFile {
  std::string name;       ///< in /dev
  std::string subsystem;  ///< "spidev"
  int major = 0, minor = 0;

  [[nodiscard]] std::string path() const { return "/dev/" + name; }
  [[nodiscard]] std::string sys_path() const { return "/sys/devices/platform/" + name; }
};

/// umockdev's machine of this process: sysfs, udev and /dev as libusb and hidapi see them. Only under umockdev-wrapper.
class Testbed {
 public:
  Testbed();
  ~Testbed();
  Testbed(const Testbed&) = delete;
  Testbed& operator=(const Testbed&) = delete;

  /// In umockdev's notation; announces what it adds.
  void add(const std::string& devices);
  void remove(const std::string& sys_path);
  void announce(const std::string& sys_path, const char* action);
  /// A file that no device has, with the folders it lies in: "/sys/module/spidev/parameters/bufsiz".
  void write_file(const std::string& path, const std::string& text);
  /// A device file whose ioctls `handler` answers, and its folder in sysfs. For a file that no earlier device had.
  void add(const DeviceFile& file, UMockdevIoctlBase* handler);
  /// For a device file that no earlier device had: umockdev refuses a second handler for one.
  [[nodiscard]] int new_number() noexcept { return ++last_number_; }
  [[nodiscard]] UMockdevTestbed* get() const noexcept { return testbed_; }

  /// Why umockdev cannot be used, empty when it can.
  [[nodiscard]] static std::string missing();

 private:
  UMockdevTestbed* testbed_;
  int last_number_ = 10;
};

/// A USB port of the testbed with an emulated eye in it.
class UsbPort {
 public:
  UsbPort(Testbed& testbed, const protocol::EmulatorSettings& eye, int port = 4);
  /// Whose time is real, as sessions want it that show something at a time.
  UsbPort(Testbed& testbed, const protocol::EmulatorSettings& eye, protocol::SampleGenerator samples);
  ~UsbPort();

  /// Plugs the eye in: a new device file.
  void plug();
  /// Takes it out; what plug() brings has this serial.
  void unplug(const std::string& next_serial);
  void unplug() { unplug(cable.serial()); }
  /// Of the last plug().
  [[nodiscard]] EmulatedUsbfs& file();
  [[nodiscard]] std::string sys_path() const { return entry_.sys_path(); }

  EmulatedCable cable;

 private:
  struct Plugged;
  Testbed& testbed_;
  UsbEntry entry_;
  bool plugged_ = false;
  std::vector<std::unique_ptr<Plugged>> all_;  // clients of earlier files may still call
};

}  // namespace compueye::hil
