// Two emulated eyes, one on USB and one on HID, in ports of this machine's own kernel. Commands come by a FIFO, a line
// each: "usb plug", "usb unplug", "usb stall", "hid plug", "hid unplug", "hid stall", "quit".

#include <sys/stat.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iostream>
#include <memory>
#include <string>

#include "hal/try.hpp"
#include "sim/scene_device.hpp"
#include "tests/hil/level3/board_in_scene.hpp"
#include "tests/hil/level3/emulated_hid_eye.hpp"
#include "tests/hil/level3/vhci_port.hpp"

namespace compueye::hil {
namespace {

// A machine that emulates a processor is slow: the device then is, too, and loses nothing.
constexpr std::int64_t most_between_looks_ns = 2'000'000;

hal::Result<std::unique_ptr<EmulatedCable>> cable_of(const std::string& folder, const std::string& scene,
                                                     const protocol::Bus& bus, const std::string& serial) {
  const BoardInScene eye = TRY(board_in_scene(folder, scene));
  protocol::EmulatorSettings settings;
  settings.bus = &bus;
  settings.descriptor = sim::describe_device(eye.simulation->board(), serial);
  settings.fifo_bytes = std::size_t{1} << 20U;
  return std::make_unique<EmulatedCable>(settings, sim::samples_of(eye.simulation), most_between_looks_ns);
}

/// An eye and the port it is in or out of.
struct Socketed {
  std::unique_ptr<EmulatedCable> cable;
  VhciPort port;

  hal::Result<void> obey(const std::string& command) {
    if (command == "unplug") {
      port.unplug();
      cable->replace(cable->serial());
    } else if (command == "stall") {
      cable->inject({.kind = protocol::FaultKind::stall_stream});
    } else if (command == "plug") {
      return port.plug();
    } else {
      return hal::fail(hal::ErrorCode::usage, command, "is no command; expected plug, unplug or stall");
    }
    return {};
  }
};

hal::Result<void> serve(const std::string& fifo, const std::string& scene, const std::string& usb_board,
                        const std::string& hid_board) {
  auto usb_cable = TRY(cable_of(usb_board, scene, protocol::usb_bus, "HIL-USB"));
  auto hid_cable = TRY(cable_of(hid_board, scene, protocol::hid_bus, "HIL-HID"));
  EmulatedCable &usb_eye = *usb_cable, &hid_eye = *hid_cable;
  const auto usb_id = protocol::usb_bus.identity, hid_id = protocol::hid_bus.identity;
  Socketed usb{std::move(usb_cable),
               VhciPort({.port = 0, .descriptors = usb_descriptors(usb_id.vendor, usb_id.product), .plugged = [&] {
                           return std::make_unique<EmulatedUsbEye>(usb_eye);
                         }})};
  Socketed hid{std::move(hid_cable),
               VhciPort({.port = 1, .descriptors = hid_descriptors(hid_id.vendor, hid_id.product), .plugged = [&] {
                           return std::make_unique<EmulatedHidEye>(hid_eye);
                         }})};
  if (::mkfifo(fifo.c_str(), S_IRUSR | S_IWUSR) != 0 && errno != EEXIST) {
    return hal::fail(hal::ErrorCode::io, fifo, std::string("cannot be made: ") + std::strerror(errno));
  }
  for (;;) {
    std::ifstream commands(fifo);  // opens when somebody writes, ends when nobody does
    for (std::string line; std::getline(commands, line);) {
      if (line == "quit") return {};
      Socketed& addressed = line.starts_with("hid ") ? hid : usb;
      const auto obeyed = addressed.obey(line.substr(line.find(' ') + 1));
      std::cout << line << ": " << (obeyed ? "done" : obeyed.error().text()) << std::endl;
    }
  }
}

}  // namespace
}  // namespace compueye::hil

int main(int argc, char** argv) {
  if (argc != 5) {
    std::cerr << "usage: vhci_eye FIFO SCENE USB_BOARD HID_BOARD\n";
    return 2;
  }
  const auto served = compueye::hil::serve(argv[1], argv[2], argv[3], argv[4]);
  if (!served) std::cerr << "vhci_eye: " << served.error().text() << "\n";
  return served ? 0 : 1;
}
