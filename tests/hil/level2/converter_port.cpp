#include "tests/hil/level2/converter_port.hpp"

#include <utility>

namespace compueye::hil {
namespace {

constexpr int ready_line = 0, select_line = 1, select_lines = 3, reset_line = 4;

std::vector<EmulatedGpiochip::Line> named_lines() {
  std::vector<EmulatedGpiochip::Line> lines(5);
  lines[ready_line].name = "DRDY";
  return lines;
}

}  // namespace

ConverterPort::ConverterPort(Testbed& testbed, frontend::EmulatedFrontEndSettings settings)
    : gpio_(testbed, named_lines()),
      converters_(std::move(settings), [this](std::int64_t t_ns) { gpio_.chip.edge(ready_line, false, t_ns); }),
      data_(testbed, converters_.data()),
      settings_(testbed, converters_.settings()) {
  gpio_.chip.at_set = [this](const EmulatedGpiochip& chip) {
    std::uint32_t number = 0;
    for (int k = 0; k < select_lines; ++k) {
      number |= (chip.lines[static_cast<std::size_t>(select_line + k)].level ? 1U : 0U) << k;
    }
    converters_.select(number);
    if (chip.lines[reset_line].output) converters_.reset_level(chip.lines[reset_line].level);
  };
}

}  // namespace compueye::hil
