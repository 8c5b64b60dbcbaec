#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hal/spi_bus.hpp"

struct spi_ioc_transfer;

namespace compueye::transport {

/// A bus through the kernel's spidev (Documentation/spi/spidev.rst), 8 bits a word. No thread of its own.
///
/// The kernel moves at most `bufsiz` bytes a call (a parameter of its module spidev, 4096 unless it is set; the sum of
/// what goes out, and of what comes in) and takes at most 511 transfers. Segments go in as few calls as that allows,
/// and where there is more than one they part where chip select is released anyway. Only where chip select has to
/// stay down for longer than one call moves is it left to the driver of the controller: the last transfer of a call
/// then has cs_change, which there means "stay selected", and which the kernel calls a hint. Where the controller
/// does not take it the chip loses its place, which its front end sees in the data; set spidev.bufsiz higher then.
class SpidevBus final : public hal::SpiBus {
 public:
  /// `path` of the device file, "/dev/spidev0.0".
  explicit SpidevBus(std::string path);
  SpidevBus(const SpidevBus&) = delete;
  SpidevBus& operator=(const SpidevBus&) = delete;
  ~SpidevBus() override;

  /// `most_bytes` is bufsiz, read by open(), and what a call still moved after one was refused as too long.
  [[nodiscard]] const hal::SpiDescription& describe() const noexcept override { return description_; }
  /// Errors: not_found, io (permission; the controller has not this mode or clock), out_of_range (no mode, no clock).
  [[nodiscard]] hal::Result<void> open(const hal::SpiMode& mode) override;
  void close() noexcept override;
  [[nodiscard]] hal::Result<void> exchange(std::span<const hal::SpiSegment> segments) override;

 private:
  /// Where an exchange has come to.
  struct Place {
    std::size_t segment = 0;
    std::size_t byte = 0;  // of the segment
  };
  /// Fills `message_` from `from` on with what one call moves; the place behind it.
  [[nodiscard]] Place fill(std::span<const hal::SpiSegment> segments, Place from) noexcept;
  [[nodiscard]] hal::Result<void> set_up(const hal::SpiMode& mode);
  /// Moves `message_`; the error number, or -1 for a wrong number of bytes, which is then in `moved_`.
  [[nodiscard]] int move() noexcept;
  void read_most_bytes() noexcept;
  /// After a message that the kernel called too long.
  void learn_limit() noexcept;
  [[nodiscard]] hal::Error failure(int error, const char* doing) const;

  std::string path_;
  hal::SpiDescription description_;
  int file_ = -1;
  std::uint32_t clock_hz_ = 0;
  std::vector<spi_ioc_transfer> message_;  // as long as the longest, of which `filled_` are used
  std::size_t grain_ = 1;                  // in which a transfer counts against most_bytes
  std::size_t filled_ = 0, bytes_ = 0;     // transfers and bytes of this message
  int moved_ = 0;
};

}  // namespace compueye::transport
