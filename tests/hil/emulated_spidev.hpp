#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "hal/spi_bus.hpp"

namespace compueye::hil {

/// What hangs on an SPI bus, as the controller sees it.
class SpiDeviceModel {
 public:
  SpiDeviceModel() = default;
  SpiDeviceModel(const SpiDeviceModel&) = delete;
  SpiDeviceModel& operator=(const SpiDeviceModel&) = delete;
  virtual ~SpiDeviceModel() = default;

  /// One message. Chip select goes down before its first segment where it is not down, up behind each with `release`,
  /// and stays down behind a last one without.
  virtual void transfer(std::span<const hal::SpiSegment> segments) = 0;
  /// The error number that the controller ends the next message with, before it moves anything; 0: none.
  [[nodiscard]] virtual int status() { return 0; }
  /// The same of the message that was just moved.
  [[nodiscard]] virtual int outcome() { return 0; }
};

/// The kernel's side of a /dev/spidevB.C, as drivers/spi/spidev.c has it.
class EmulatedSpidev {
 public:
  struct Answer {
    int result = 0;
    int error = 0;
  };
  struct Limits {
    std::size_t bufsiz = 4096;  ///< of all transfers of a message, in each direction
    std::size_t grain = 1;      ///< in which a transfer counts against it: ARCH_DMA_MINALIGN
    std::size_t controller = static_cast<std::size_t>(-1);  ///< what one message may move at most
    std::uint32_t modes = 0b1111;                           ///< bit k: has mode k
    std::uint32_t most_hz = 50'000'000;                     ///< a faster clock is refused
  };
  struct Counters {
    int messages = 0;  ///< that were moved
    int refused = 0;   ///< that were too long
    std::size_t bytes = 0, most_bytes = 0, most_transfers = 0;
  };

  explicit EmulatedSpidev(SpiDeviceModel& device) : device_(device) {}

  [[nodiscard]] Answer ioctl(unsigned long request, void* argument);

  /// Of every transfer from now on, what the controller says it moved less than it was asked.
  void say_fewer(int bytes) noexcept { fewer_ = bytes; }
  /// The controller's driver goes away under open files.
  void unbind() noexcept { bound_ = false; }
  /// Reads back another clock and mode than were written.
  void forget_settings() noexcept { forgets_ = true; }

  [[nodiscard]] std::uint32_t mode() const noexcept { return mode_; }
  [[nodiscard]] std::uint32_t hz() const noexcept { return hz_; }
  [[nodiscard]] int word_bits() const noexcept { return word_bits_; }
  [[nodiscard]] std::uint32_t transfer_hz() const noexcept { return transfer_hz_; }  ///< of the last transfer
  [[nodiscard]] const Counters& counters() const noexcept { return counters_; }

  Limits limits;

 private:
  [[nodiscard]] Answer message(std::size_t bytes_of_transfers, const void* argument);
  [[nodiscard]] Answer write_mode(std::uint32_t mode);

  SpiDeviceModel& device_;
  Counters counters_;
  bool bound_ = true, forgets_ = false;
  int fewer_ = 0, word_bits_ = 0;
  std::uint32_t mode_ = 0, hz_ = 500'000, transfer_hz_ = 0;
};

}  // namespace compueye::hil
