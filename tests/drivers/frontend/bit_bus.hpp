#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "drivers/frontend/chip_emulator.hpp"
#include "drivers/frontend/clocked_chips.hpp"
#include "hal/signal_lines.hpp"
#include "hal/spi_bus.hpp"

namespace compueye::frontend::tests {

/// The chips' data bus. Positions of faults count from the last arm() on.
class BitBus final : public hal::SpiBus {
 public:
  BitBus(std::vector<ChipEmulator*> chips, bool chain, const std::uint32_t& address)
      : chips_(std::move(chips), chain ? Hookup::chain : Hookup::addressed), address_(address) {}

  [[nodiscard]] const hal::SpiDescription& describe() const noexcept override { return description_; }
  [[nodiscard]] hal::Result<void> open(const hal::SpiMode& /*mode*/) override { return {}; }
  void close() noexcept override {}
  [[nodiscard]] hal::Result<void> exchange(std::span<const hal::SpiSegment> segments) override {
    chips_.exchange(segments, address_, faults_, clocks_);
    return {};
  }

  void arm(const BusFaults& faults) noexcept {
    faults_ = faults;
    clocks_ = 0;
  }

 private:
  ClockedChips chips_;
  const std::uint32_t& address_;
  BusFaults faults_;
  std::size_t clocks_ = 0;
  hal::SpiDescription description_{.name = "bits", .most_bytes = 4096};
};

/// The settings' own wires, which go to every chip.
class SettingsBus final : public hal::SpiBus {
 public:
  explicit SettingsBus(std::vector<ChipEmulator*> chips) : chips_(std::move(chips), Hookup::chain) {}
  [[nodiscard]] const hal::SpiDescription& describe() const noexcept override { return description_; }
  [[nodiscard]] hal::Result<void> open(const hal::SpiMode& /*mode*/) override { return {}; }
  void close() noexcept override {}
  [[nodiscard]] hal::Result<void> exchange(std::span<const hal::SpiSegment> segments) override {
    chips_.exchange_settings(segments);
    return {};
  }

 private:
  ClockedChips chips_;
  hal::SpiDescription description_{.name = "settings", .most_bytes = 4096};
};

/// Lines that remember their levels; one that resets the chips when it comes from low to high.
class Lines final : public hal::OutputLines {
 public:
  explicit Lines(int count, std::vector<ChipEmulator*> reset = {}) : count_(count), reset_(std::move(reset)) {}
  [[nodiscard]] const std::string& name() const noexcept override { return name_; }
  [[nodiscard]] int count() const noexcept override { return count_; }
  [[nodiscard]] hal::Result<void> open() override { return {}; }
  void close() noexcept override {}
  [[nodiscard]] hal::Result<void> set(std::uint32_t levels) override {
    if (levels != 0 && this->levels == 0) {
      for (ChipEmulator* chip : reset_) chip->reset_pin();
    }
    this->levels = levels;
    return {};
  }

  std::uint32_t levels = 0;

 private:
  int count_;
  std::vector<ChipEmulator*> reset_;
  std::string name_ = "lines";
};

}  // namespace compueye::frontend::tests
