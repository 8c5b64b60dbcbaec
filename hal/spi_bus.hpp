#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "hal/result.hpp"

namespace compueye::hal {

/// How a chip wants to be spoken to.
struct SpiMode {
  int mode = 0;                ///< 0 .. 3: 2 CPOL + CPHA
  std::uint32_t clock_hz = 0;  ///< at most; > 0
};

/// A stretch of clocks, full duplex, the most significant bit of each byte first.
struct SpiSegment {
  std::span<const std::byte> out = {};  ///< to the chip; empty: zeros
  std::span<std::byte> in = {};         ///< from the chip; empty: thrown away. As long as `out`, where neither is empty
  bool release = false;                 ///< chip select goes up behind it, and down again for the next one
  std::uint16_t pause_us = 0;           ///< behind it, before chip select moves

  [[nodiscard]] std::size_t bytes() const noexcept { return std::max(out.size(), in.size()); }
};

struct SpiDescription {
  std::string name;            ///< "spidev0.0", "emulator"
  std::size_t most_bytes = 0;  ///< that one call of the kernel can move; 0: any
};

/// A serial bus with one chip select: chips, or a chain of them, that answer while they are asked. One thread.
class SpiBus {
 public:
  SpiBus() = default;
  SpiBus(const SpiBus&) = delete;
  SpiBus& operator=(const SpiBus&) = delete;
  virtual ~SpiBus() = default;

  [[nodiscard]] virtual const SpiDescription& describe() const noexcept = 0;

  /// Errors: not_found (no such device file), io (permission; a mode or clock that the bus has not), out_of_range.
  [[nodiscard]] virtual Result<void> open(const SpiMode& mode) = 0;
  virtual void close() noexcept = 0;

  /// All segments in their order: chip select goes down before the first, up where one releases it and behind the last.
  /// Either every byte was moved or there is an error: disconnected (the device file is gone), io, usage (not open, a
  /// segment whose sizes differ). Does not use the heap unless it fails.
  [[nodiscard]] virtual Result<void> exchange(std::span<const SpiSegment> segments) = 0;
};

}  // namespace compueye::hal
