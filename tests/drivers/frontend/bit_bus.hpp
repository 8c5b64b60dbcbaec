#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "drivers/frontend/chip_emulator.hpp"
#include "hal/signal_lines.hpp"
#include "hal/spi_bus.hpp"

namespace compueye::frontend::tests {

/// What happens on the wires. Positions count from the last arm() on, in clocks or bytes of the data bus.
struct BitFaults {
  std::optional<std::size_t> lost_clock{};     ///< the chip does not see it; the line stays as it was
  std::optional<std::size_t> doubled_clock{};  ///< the chip sees two, and the host the bit of the first
  std::optional<std::size_t> turned_bit{};     ///< on its way to the host
  std::optional<std::size_t> brown_out{};      ///< power comes back to `chip` before this byte
  std::size_t chip = 0;
  std::optional<bool> stuck{};  ///< the host's input
};

/// Wires to emulated chips, clock by clock: all behind one another, or the one that `address` says. What nobody drives
/// is pulled up.
class BitBus final : public hal::SpiBus {
 public:
  BitBus(std::vector<ChipEmulator*> chips, bool chain, const std::uint32_t& address)
      : chips_(std::move(chips)), chain_(chain), address_(address) {}

  [[nodiscard]] const hal::SpiDescription& describe() const noexcept override { return description_; }
  [[nodiscard]] hal::Result<void> open(const hal::SpiMode& /*mode*/) override { return {}; }
  void close() noexcept override {}

  [[nodiscard]] hal::Result<void> exchange(std::span<const hal::SpiSegment> segments) override {
    bool selected = false;
    for (const hal::SpiSegment& segment : segments) {
      if (!selected) select(true);
      selected = true;
      for (std::size_t k = 0; k < segment.bytes(); ++k) {
        const auto in = byte(segment.out.empty() ? 0U : std::to_integer<unsigned>(segment.out[k]));
        if (!segment.in.empty()) segment.in[k] = static_cast<std::byte>(in);
      }
      if (segment.release) select(selected = false);
    }
    if (selected) select(false);
    return {};
  }

  void arm(const BitFaults& faults) noexcept {
    faults_ = faults;
    clocks_ = 0;
  }
  BitFaults& faults() noexcept { return faults_; }

 private:
  void select(bool low) noexcept {
    for (std::size_t c = 0; c < chips_.size(); ++c) {
      if (!chain_ && c != address_) continue;
      low ? chips_[c]->select() : chips_[c]->release();
    }
    line_ = true;
  }

  unsigned byte(unsigned out) noexcept {
    if (faults_.brown_out && clocks_ == 8 * *faults_.brown_out) chips_[faults_.chip]->power_on();
    unsigned in = 0;
    for (unsigned bit = 0; bit < 8; ++bit, ++clocks_) {
      const bool sent = (out >> (7U - bit) & 1U) != 0;
      if (faults_.lost_clock != clocks_) line_ = clock(sent);
      const bool seen = line_ != (faults_.turned_bit == clocks_);
      if (faults_.doubled_clock == clocks_) line_ = clock(sent);
      in = in << 1U | (faults_.stuck.value_or(seen) ? 1U : 0U);
    }
    return in;
  }

  bool clock(bool sent) noexcept {
    if (!chain_) return address_ >= chips_.size() || chips_[address_]->clock(sent);
    bool level = false;  // the far end of a chain is tied low
    for (std::size_t c = chips_.size(); c-- > 0;) level = chips_[c]->clock(level);
    return level;
  }

  std::vector<ChipEmulator*> chips_;
  bool chain_;
  const std::uint32_t& address_;
  BitFaults faults_;
  std::size_t clocks_ = 0;
  bool line_ = true;
  hal::SpiDescription description_{.name = "bits", .most_bytes = 4096};
};

/// The settings' own wires, which go to every chip.
class SettingsBus final : public hal::SpiBus {
 public:
  explicit SettingsBus(std::vector<ChipEmulator*> chips) : chips_(std::move(chips)) {}
  [[nodiscard]] const hal::SpiDescription& describe() const noexcept override { return description_; }
  [[nodiscard]] hal::Result<void> open(const hal::SpiMode& /*mode*/) override { return {}; }
  void close() noexcept override {}
  [[nodiscard]] hal::Result<void> exchange(std::span<const hal::SpiSegment> segments) override {
    for (const hal::SpiSegment& segment : segments) {
      for (const std::byte b : segment.out) {
        for (unsigned bit = 8; bit-- > 0;) {
          for (ChipEmulator* chip : chips_) chip->settings_clock((std::to_integer<unsigned>(b) >> bit & 1U) != 0);
        }
      }
    }
    return {};
  }

 private:
  std::vector<ChipEmulator*> chips_;
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
