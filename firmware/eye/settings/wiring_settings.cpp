#include "drivers/frontend/front_end.hpp"
#include "firmware/eye/settings/field.hpp"
#include "firmware/eye/settings/setting.hpp"

namespace compueye::firmware {
namespace {

using V = SettingValue;

std::vector<std::string_view> chip_names() {
  std::vector<std::string_view> names;
  for (const frontend::FrontEndRow* row : frontend::front_ends()) names.push_back(row->name);
  return names;
}

}  // namespace

std::vector<Setting> wiring_settings() {
  std::vector<Setting> all;
  add(all, "wiring",
      {field<&Board::wiring, &WiringSettings::chip>("chip", "the converter; required by kind \"spi\"")
           .one_of(chip_names()),
       field<&Board::wiring, &WiringSettings::chips>("chips", "how many of it, in a chain or with an address each")
           .within({1, 1024})
           .otherwise(1),
       field<&Board::wiring, &WiringSettings::data>(
           "data", "device file of the bus that data come by, /dev/spidev0.0; required by kind \"spi\"")
           .otherwise(""),
       field<&Board::wiring, &WiringSettings::clock_hz>("clock_hz", "of that bus; 0: as fast as the chip goes")
           .within({0, 100e6})
           .otherwise(0),
       field<&Board::wiring, &WiringSettings::settings>(
           "settings", "device file of the bus that settings go by, where the chip has wires of their own for them")
           .otherwise(""),
       field<&Board::wiring, &WiringSettings::range>("range", "of the chip's inputs; left out, its first")
           .otherwise(""),
       field<&Board::wiring, &WiringSettings::data_ready>(
           "data_ready", "line that falls when a frame is complete, \"gpiochip0 17\" or by its name \"gpiochip0 DRDY\"")
           .otherwise(""),
       field<&Board::wiring, &WiringSettings::select>(
           "select",
           "lines of a chip's number, the lowest bit first, \"gpiochip0 5 6 13\"; for chips that are no chain")
           .otherwise(""),
       field<&Board::wiring, &WiringSettings::reset>("reset", "line that resets the chips while it is low")
           .otherwise(""),
       field<&Board::wiring, &WiringSettings::sync>("sync", "line that is high while a frame is read").otherwise(""),
       field<&Board::wiring, &WiringSettings::ommatidia>(
           "ommatidia", "of each channel, all of them in any order; left out, channel c is ommatidium c")
           .within({0, 65535})
           .stored(
               [](Board& board, const V& value) {  // in the order in which they are given
                 const auto& list = std::get<std::vector<std::int64_t>>(value);
                 board.wiring.ommatidia.assign(list.begin(), list.end());
               },
               [](const Board& board) { return value_of(board.wiring.ommatidia); })
           .otherwise(V{std::vector<std::int64_t>()})});
  add(all, "lamps",
      {field<&Board::lamps, &LampSettings::lines>(
           "lines", "a line for each pixel of [object], row 0 first, at most 32, \"gpiochip0 5 6 13 19\"")
           .otherwise(""),
       field<&Board::lamps, &LampSettings::active_low>("active_low", "a lamp is lit while its line is low")
           .otherwise(V{false}),
       field<&Board::lamps, &LampSettings::settle_ms>("settle_ms", "from a line's level to stable light")
           .within({0, 10e3})
           .otherwise(1)});
  return all;
}

}  // namespace compueye::firmware
