#include "firmware/eye/lamp_lines.hpp"

#include "drivers/device/hang_proof_lines.hpp"
#include "drivers/transport/gpio_gpiod.hpp"
#include "firmware/eye/board_wiring.hpp"

namespace compueye::firmware {

std::unique_ptr<hal::OutputLines> lamp_lines(const LampSettings& lamps) {
  const auto names = line_names(lamps.lines);
  if (!names) return nullptr;
  return std::make_unique<device::HangProofLines>(std::make_unique<transport::GpioOutputLines>(
      transport::GpioOutputSettings{names->chip, names->lines, lamps.active_low}));
}

}  // namespace compueye::firmware
