#include <algorithm>
#include <array>

#include "drivers/frontend/ads8688.hpp"
#include "drivers/frontend/chip_emulator.hpp"

namespace compueye::frontend {
namespace {

/// SBAS582C sections 8.4 and 8.5. Of the commands, AUX is missing; of the registers, the alarms of the later ADS8688A.
class Ads8688Emulator final : public ChipEmulator {
 public:
  /// Section 8.5.1: the command register is 0, and the chip waits for a command.
  void power_on() noexcept override {
    reset_registers();
    listening_ = false;
  }
  void reset_pin() noexcept override { reset_registers(); }

  void select() noexcept override {
    listening_ = true;
    clocks_ = 0;
    command_ = 0;
    stream_ = mode_ == Mode::idle ? 0 : conversion();
  }

  bool clock(bool in) noexcept override {
    if (!listening_) return false;
    if (clocks_ < 16) command_ = (command_ << 1U | (in ? 1U : 0U)) & 0xFFFFU;
    const bool out = clocks_ >= 16 && clocks_ < 48 && (stream_ >> (47 - clocks_) & 1U) != 0;
    if (++clocks_ == 16 && is_register_access()) {
      stream_ = (writes() ? command_ & 0xFFU : registers_[address()]) << 24U;
    }
    return out;
  }

  /// Section 8.4.2.2: before the 16th clock chip select aborts the frame. Otherwise its command is carried out now.
  void release() noexcept override {
    if (listening_ && clocks_ >= 16) carry_out();
    listening_ = false;
  }

  void convert(std::span<const std::int32_t> codes) noexcept override {
    std::copy_n(codes.begin(), codes_.size(), codes_.begin());
  }

 private:
  enum class Mode : std::uint8_t { idle, sequence, manual };

  [[nodiscard]] bool is_register_access() const noexcept { return command_ < 0x8000U && address() != 0; }
  [[nodiscard]] unsigned address() const noexcept { return command_ >> 9U & 0x3FU; }
  [[nodiscard]] bool writes() const noexcept { return (command_ & 0x100U) != 0; }

  void reset_registers() noexcept {
    registers_.fill(0);
    registers_[0x01] = 0xFF;
    mode_ = Mode::idle;
    channel_ = 0;
  }

  /// Table 13, from the clock behind the command on, with the tail that Feature Select asks for.
  [[nodiscard]] unsigned conversion() const noexcept {
    const unsigned format = registers_[0x03] & 7U;
    unsigned bits = static_cast<unsigned>(codes_[channel_]) << 16U;
    if (format >= 1) bits |= channel_ << 12U;
    if (format >= 2) bits |= static_cast<unsigned>(registers_[0x03] >> 6U) << 10U;
    if (format == 3) bits |= (registers_[0x05 + channel_] & 7U) << 7U;
    return bits;
  }

  [[nodiscard]] unsigned enabled_from(unsigned first) const noexcept {
    const unsigned enabled = registers_[0x01] & ~static_cast<unsigned>(registers_[0x02]);
    for (unsigned step = 0; step < 8; ++step) {
      if ((enabled >> ((first + step) % 8) & 1U) != 0) return (first + step) % 8;
    }
    return 0;
  }

  void carry_out() noexcept {
    if (is_register_access()) {
      if (writes()) write(address(), command_ & 0xFFU);
      return;
    }
    switch (command_) {
      case 0x0000:
        if (mode_ == Mode::sequence) channel_ = enabled_from(channel_ + 1);
        break;
      case 0x8200:
      case 0x8300:
        mode_ = Mode::idle;
        break;
      case 0x8500:
        reset_registers();
        break;
      case 0xA000:
        mode_ = Mode::sequence;
        channel_ = enabled_from(0);
        break;
      default:
        if (command_ >= 0xC000U && command_ <= 0xDC00U && (command_ & 0x3FFU) == 0) {
          mode_ = Mode::manual;
          channel_ = command_ >> 10U & 7U;
        }
    }
  }

  /// The register map: bits that must be zero stay so.
  void write(unsigned to, unsigned value) noexcept {
    const unsigned kept = to == 0x01 || to == 0x02 ? 0xFFU : to == 0x03 ? 0xC7U : to >= 0x05 && to <= 0x0C ? 0x0FU : 0U;
    registers_[to] = static_cast<std::uint8_t>(value & kept);
  }

  std::array<std::uint8_t, 64> registers_{};
  std::array<std::int32_t, 8> codes_{};
  Mode mode_ = Mode::idle;
  unsigned channel_ = 0;
  bool listening_ = false;
  int clocks_ = 0;
  unsigned command_ = 0;
  unsigned stream_ = 0;
};

}  // namespace

std::unique_ptr<ChipEmulator> emulate_ads8688() {
  return std::make_unique<Ads8688Emulator>();
}

}  // namespace compueye::frontend
