#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "drivers/frontend/emulated_front_end.hpp"
#include "hal/clock.hpp"
#include "hal/signal_lines.hpp"
#include "hal/spi_bus.hpp"

namespace compueye::frontend {

/// The wires of an EmulatedFrontEnd as hal has them, with the errors of real ones. An exchange takes the time that its
/// clocks take, and waiting sleeps on the clock until there is an edge, so that under a VirtualClock time goes exactly
/// as far as it must. Front end and clock outlive them.
class EmulatedSpiBus final : public hal::SpiBus {
 public:
  EmulatedSpiBus(EmulatedFrontEnd& front_end, hal::Clock& clock, bool settings = false);

  [[nodiscard]] const hal::SpiDescription& describe() const noexcept override { return description_; }
  [[nodiscard]] hal::Result<void> open(const hal::SpiMode& mode) override;
  void close() noexcept override { open_ = false; }
  [[nodiscard]] hal::Result<void> exchange(std::span<const hal::SpiSegment> segments) override;

 private:
  EmulatedFrontEnd& front_end_;
  hal::Clock& clock_;
  hal::SpiDescription description_;
  bool settings_ = false, open_ = false;
};

class EmulatedEdgeLine final : public hal::EdgeLine {
 public:
  EmulatedEdgeLine(EmulatedFrontEnd& front_end, hal::Clock& clock) : front_end_(front_end), clock_(clock) {}

  [[nodiscard]] const std::string& name() const noexcept override { return name_; }
  [[nodiscard]] hal::Result<void> open() override;
  void close() noexcept override { open_ = false; }
  [[nodiscard]] hal::Result<hal::Edge> wait(std::int64_t deadline_ns) override;

 private:
  EmulatedFrontEnd& front_end_;
  hal::Clock& clock_;
  std::string name_ = "emulated data-ready";
  bool open_ = false;
};

/// What the levels are for.
enum class OutputUse { select, reset };

class EmulatedOutputLines final : public hal::OutputLines {
 public:
  EmulatedOutputLines(EmulatedFrontEnd& front_end, hal::Clock& clock, OutputUse use);

  [[nodiscard]] const std::string& name() const noexcept override { return name_; }
  [[nodiscard]] int count() const noexcept override { return use_ == OutputUse::reset ? 1 : 5; }
  [[nodiscard]] hal::Result<void> open() override;
  void close() noexcept override { open_ = false; }
  [[nodiscard]] hal::Result<void> set(std::uint32_t levels) override;

 private:
  EmulatedFrontEnd& front_end_;
  hal::Clock& clock_;
  OutputUse use_;
  std::string name_;
  bool open_ = false;
};

}  // namespace compueye::frontend
