#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "hal/signal_lines.hpp"

namespace compueye::transport {

enum class GpioBias : std::uint8_t { as_is, off, pull_up, pull_down };

/// A line is given by its number on the chip ("17") or by its name ("DRDY"), which then is not all digits.
struct GpioEdgeSettings {
  std::string chip = "gpiochip0";  ///< name in /dev, or a path
  std::string line = {};
  bool falling = false;  ///< the edge that counts; else the rising one
  GpioBias bias = GpioBias::as_is;
};

struct GpioOutputSettings {
  std::string chip = "gpiochip0";
  std::vector<std::string> lines = {};  ///< 1 to 32, line k's at k
  bool active_low = false;              ///< level 1 is the low voltage; after open() all are at level 0, so high
};

class GpioLines;

/// A line that is watched through libgpiod, 1.6 or 2 (gpio_lines.hpp); no thread.
///
/// Times are those of the kernel's interrupt handler, CLOCK_MONOTONIC: with libgpiod 2 because it is asked for,
/// with 1.6 because kernels from 5.7 on use it (older ones the time of day, which is not told apart here).
///
/// The kernel keeps 16 edges that nobody has read. Beyond these libgpiod 2's loses the oldest and goes on counting, so
/// that a step in Edge::number shows it; 1.6's loses the newest, and nothing shows it. An edge that comes while the
/// handler of the one before is at work can be lost before it is counted.
class GpioEdgeLine final : public hal::EdgeLine {
 public:
  explicit GpioEdgeLine(GpioEdgeSettings settings);
  GpioEdgeLine(const GpioEdgeLine&) = delete;
  GpioEdgeLine& operator=(const GpioEdgeLine&) = delete;
  ~GpioEdgeLine() override;

  [[nodiscard]] const std::string& name() const noexcept override { return name_; }
  /// Errors: not_found (names the chips there are), io (permission; names the program that has the line), unsupported.
  [[nodiscard]] hal::Result<void> open() override;
  void close() noexcept override;
  /// Also: usage (not open).
  [[nodiscard]] hal::Result<hal::Edge> wait(std::int64_t deadline_ns) override;

 private:
  /// Until there is something to read.
  [[nodiscard]] hal::Result<void> wait_for_more(std::int64_t deadline_ns) const;

  GpioEdgeSettings settings_;
  std::string name_;
  std::unique_ptr<GpioLines> lines_;
  std::array<hal::Edge, 16> edges_{};  // read, of which those from next_ on are to be given
  std::size_t next_ = 0, filled_ = 0;
  std::uint64_t number_ = 0;  // of the last edge read, where they are numbered
};

/// Lines that are set in one call of the kernel, through libgpiod, 1.6 or 2; no thread. Bits beyond count() are
/// ignored.
class GpioOutputLines final : public hal::OutputLines {
 public:
  explicit GpioOutputLines(GpioOutputSettings settings);
  GpioOutputLines(const GpioOutputLines&) = delete;
  GpioOutputLines& operator=(const GpioOutputLines&) = delete;
  ~GpioOutputLines() override;

  [[nodiscard]] const std::string& name() const noexcept override { return name_; }
  [[nodiscard]] int count() const noexcept override { return static_cast<int>(settings_.lines.size()); }
  /// Errors: as GpioEdgeLine's, and out_of_range (no line, or more than 32).
  [[nodiscard]] hal::Result<void> open() override;
  void close() noexcept override;
  [[nodiscard]] hal::Result<void> set(std::uint32_t levels) override;

 private:
  GpioOutputSettings settings_;
  std::string name_;
  std::unique_ptr<GpioLines> lines_;
};

}  // namespace compueye::transport
