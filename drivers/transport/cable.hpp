#pragma once

#include <memory>
#include <string>
#include <vector>

#include "drivers/protocol/bus.hpp"
#include "hal/byte_transport.hpp"
#include "hal/result.hpp"

namespace compueye::transport {

/// An eye found on a bus. Firmware and ommatidia come out of its descriptor, by control() of an open transport.
struct FoundEye {
  std::string bus;      ///< "usb 1-4" (bus and ports, the same after every plugging-in), "hidraw2"
  std::string path;     ///< of the device file
  std::string serial;   ///< as the system noted it when the eye came, else asked for; empty when neither worked
  std::string product;  ///< likewise
  hal::Error refusal;   ///< why it could not be opened; an empty place when it could

  [[nodiscard]] bool reachable() const noexcept { return refusal.place.empty(); }
};

/// What every transport offers: a row for firmware/eye/source_list.cpp.
struct Cable {
  const protocol::Bus& bus;
  /// What is attached now, ordered by bus; an eye that may not be opened is listed with the reason. Each call looks
  /// afresh. Error io: the bus cannot be looked at on this machine.
  hal::Result<std::vector<FoundEye>> (*list)();
  /// To the eye with this serial, or with an empty one to the first that open() finds.
  std::unique_ptr<hal::ByteTransport> (*connect)(const std::string& serial);
};

/// Error not_found of an open() that found none of the eyes it may take: `others` are those that are there.
[[nodiscard]] inline hal::Error no_eye(const protocol::Bus& bus, const std::string& serial,
                                       const std::vector<FoundEye>& others) {
  std::string list;
  for (const FoundEye& each : others) list += (list.empty() ? "" : ", ") + each.serial + " (" + each.bus + ")";
  return {hal::ErrorCode::not_found, serial.empty() ? std::string(bus.name) : serial,
          (serial.empty() ? "no eye" : "no eye with serial '" + serial + "'") + " is on " + std::string(bus.title) +
              (list.empty() ? "" : "; there are " + list) + "; plug it in"};
}

}  // namespace compueye::transport
