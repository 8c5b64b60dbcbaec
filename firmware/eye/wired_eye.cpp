#include "firmware/eye/wired_eye.hpp"

#include <utility>

#include "drivers/device/converter_source.hpp"
#include "drivers/transport/gpio_gpiod.hpp"
#include "drivers/transport/spi_spidev.hpp"
#include "firmware/eye/board_wiring.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

std::unique_ptr<hal::OutputLines> outputs(const std::string& text) {
  const auto names = line_names(text);
  if (!names) return nullptr;
  return std::make_unique<transport::GpioOutputLines>(transport::GpioOutputSettings{names->chip, names->lines, false});
}

/// DRDY and DVALID of all chips are low when data are ready.
std::unique_ptr<hal::EdgeLine> data_ready(const std::string& text) {
  const auto names = line_names(text);
  if (!names) return nullptr;
  return std::make_unique<transport::GpioEdgeLine>(
      transport::GpioEdgeSettings{names->chip, names->lines.front(), true, transport::GpioBias::as_is});
}

}  // namespace

hal::Result<std::unique_ptr<hal::SampleSource>> wired_eye(const Board& board, hal::Clock& clock) {
  const WiringSettings& wiring = board.wiring;
  device::ConverterSettings settings;
  settings.chip = frontend::find_front_end(wiring.chip);
  settings.front_end = TRY(front_end_settings(board));
  settings.serial = board.source.serial;
  settings.ommatidium_of_channel.assign(wiring.ommatidia.begin(), wiring.ommatidia.end());
  device::ConverterWires wires;
  wires.data = std::make_unique<transport::SpidevBus>(wiring.data);
  if (!wiring.settings.empty()) wires.settings = std::make_unique<transport::SpidevBus>(wiring.settings);
  wires.select = outputs(wiring.select);
  wires.reset = outputs(wiring.reset);
  wires.sync = outputs(wiring.sync);
  wires.ready = data_ready(wiring.data_ready);
  return TRY(device::ConverterSource::create(std::move(settings), std::move(wires), clock));
}

}  // namespace compueye::firmware
