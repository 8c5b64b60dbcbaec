#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace compueye::frontend {

/// A converter as its datasheet describes it, seen from its pins: what the front end's file knows, known again from the
/// other side, so that neither tests itself. Bits go most significant first.
class ChipEmulator {
 public:
  ChipEmulator() = default;
  ChipEmulator(const ChipEmulator&) = delete;
  ChipEmulator& operator=(const ChipEmulator&) = delete;
  virtual ~ChipEmulator() = default;

  /// Power comes: registers are what the datasheet says they are then.
  virtual void power_on() noexcept = 0;
  /// The reset pin goes low and high again. Chips without one do nothing.
  virtual void reset_pin() noexcept {}

  /// Chip select falls, or rises.
  virtual void select() noexcept {}
  virtual void release() noexcept {}
  /// One clock of the data bus while it is selected: the bit at its input, and the one at its output. A chip that does
  /// not drive its output leaves the line to the pull-up: true.
  [[nodiscard]] virtual bool clock(bool in) noexcept = 0;
  /// One clock of the settings' own wires.
  virtual void settings_clock(bool /*in*/) noexcept {}

  /// A conversion is complete, of these codes (FrontEndRow::channels of them, from 0 to 2^bits - 1).
  virtual void convert(std::span<const std::int32_t> codes) noexcept = 0;
};

}  // namespace compueye::frontend
