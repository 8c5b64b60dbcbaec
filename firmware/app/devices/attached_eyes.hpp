#pragma once

#include <string>
#include <vector>

#include "hal/clock.hpp"
#include "hal/result.hpp"
#include "hal/sample_source.hpp"

namespace compueye::firmware {

/// An eye on a cable: where it is, and what it says of itself or why it could not be asked.
struct AttachedEye {
  std::string kind;  ///< "usb" or "hid"
  std::string bus;   ///< "usb 1-4", "hidraw2"
  std::string serial;
  std::string product;
  hal::Result<hal::SourceDescription> description;
};

struct AttachedEyes {
  std::vector<AttachedEye> eyes;   ///< by bus
  std::vector<std::string> notes;  ///< a bus that could not be looked at, a sentence each
};

/// Looks for eyes on USB and HID and asks each what it is, for a second at most. An eye that another program runs is
/// listed with the reason why it could not be asked.
[[nodiscard]] AttachedEyes list_attached_eyes(hal::Clock& clock);

}  // namespace compueye::firmware
