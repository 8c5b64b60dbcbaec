#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "drivers/frontend/chip_emulator.hpp"
#include "hal/spi_bus.hpp"

namespace compueye::frontend {

/// What happens on the wires of a bus, each at a clock of it (brown-outs: before a byte).
struct BusFaults {
  std::optional<std::size_t> lost_clock{};     ///< the chip does not see it; the line stays as it was
  std::optional<std::size_t> doubled_clock{};  ///< the chip sees two, and the host the bit of the first
  std::optional<std::size_t> turned_bit{};     ///< on its way to the host
  std::optional<std::size_t> select_glitch{};  ///< chip select goes up and down again before this clock
  std::optional<std::size_t> brown_out{};      ///< power comes back to `chip` before this byte
  std::size_t chip = 0;
  std::optional<bool> stuck{};  ///< the host's input
};

/// How chips hang on their data bus.
enum class Hookup : std::uint8_t {
  addressed,  ///< beside one another: the one that the address says
  chain,      ///< behind one another, the last one's input tied low
  alone,      ///< one, whatever the address says
};

/// Emulated chips and the wires to them, clock by clock. What nobody drives is pulled up. The chips outlive it.
class ClockedChips {
 public:
  ClockedChips(std::vector<ChipEmulator*> chips, Hookup hookup) : chips_(std::move(chips)), hookup_(hookup) {}

  /// As hal::SpiBus::exchange() has it. `clocks`: how many there were before, of those that `faults` counts; goes on.
  void exchange(std::span<const hal::SpiSegment> segments, std::uint32_t address, const BusFaults& faults,
                std::size_t& clocks);
  /// By the settings' own wires, which go to every chip.
  void exchange_settings(std::span<const hal::SpiSegment> segments);

 private:
  void select(bool low, std::uint32_t address) noexcept;
  [[nodiscard]] bool clock(bool sent, std::uint32_t address) noexcept;
  [[nodiscard]] std::byte byte(std::byte out, std::uint32_t address, const BusFaults& faults,
                               std::size_t& clocks) noexcept;

  std::vector<ChipEmulator*> chips_;
  Hookup hookup_;
  bool line_ = true;
};

}  // namespace compueye::frontend
