#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tests/hil/emulated_hidraw.hpp"
#include "tests/hil/level2/testbed.hpp"

namespace compueye::hil {

/// A USB port of the testbed with an emulated HID eye in it.
class HidPort {
 public:
  HidPort(Testbed& testbed, const protocol::EmulatorSettings& eye, int port = 6);
  ~HidPort();

  /// Plugs the eye in: a new device file.
  void plug();
  /// Takes it out; what plug() brings has this serial.
  void unplug(const std::string& next_serial);
  void unplug() { unplug(cable.serial()); }
  /// Of the last plug().
  [[nodiscard]] EmulatedHidraw& file();
  [[nodiscard]] std::string name() const { return entry_.name(); }  ///< "hidraw11"

  EmulatedCable cable;

 private:
  struct Plugged;
  Testbed& testbed_;
  HidEntry entry_;
  bool plugged_ = false;
  std::vector<std::unique_ptr<Plugged>> all_;  // clients of earlier files may still call
};

}  // namespace compueye::hil
