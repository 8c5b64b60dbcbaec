#include <algorithm>
#include <array>

#include "drivers/frontend/chip_emulator.hpp"
#include "drivers/frontend/ddc264.hpp"

namespace compueye::frontend {
namespace {

/// SBAS368C pp. 19 to 23, as far as it is known here: ddc264.cpp says what of it is not verified, and what is wrong
/// there may be wrong here. Chip select is not used.
class Ddc264Emulator final : public ChipEmulator {
 public:
  /// P. 21: the configuration is zeros.
  void power_on() noexcept override {
    configuration_ = 0;
    settings_clocks_ = 0;
    bits_.fill(false);
    at_ = 0;
  }
  void reset_pin() noexcept override { power_on(); }

  /// The output register: what is shifted in comes out behind the chip's own bits.
  bool clock(bool in) noexcept override {
    const bool out = bits_[at_];
    bits_[at_] = in;
    at_ = (at_ + 1) % length();
    return out;
  }

  /// After the sixteenth bit the register is written, and what is read back stands in the output register.
  void settings_clock(bool in) noexcept override {
    shifted_ = (shifted_ << 1U | (in ? 1U : 0U)) & 0xFFFFU;
    if (++settings_clocks_ < 16) return;
    settings_clocks_ = 0;
    configuration_ = shifted_;
    at_ = 0;
    for (int copy = 0; copy < 2; ++copy) append_read_back();
    at_ = 0;
  }

  /// Input 64 first, 20 bits or the upper 16 of them.
  void convert(std::span<const std::int32_t> codes) noexcept override {
    at_ = 0;
    for (std::size_t input = 64; input-- > 0;) {
      const auto code = static_cast<unsigned>(codes[input]);
      append(is_20_bits() ? code : code >> 4U, is_20_bits() ? 20 : 16);
    }
    at_ = 0;
  }

 private:
  [[nodiscard]] bool is_20_bits() const noexcept { return (configuration_ & 0x0100U) != 0; }
  [[nodiscard]] std::size_t length() const noexcept { return is_20_bits() ? 1280 : 1024; }

  void append(std::uint64_t value, unsigned count) noexcept {
    while (count-- > 0) bits_[at_++] = (value >> count & 1U) != 0;
  }
  void append_zeros(unsigned count) noexcept {
    while (count-- > 0) bits_[at_++] = false;
  }

  /// P. 21 and table 9: 1280 or 1024 bits in two copies.
  void append_read_back() noexcept {
    constexpr unsigned revision = 1;
    append_zeros(is_20_bits() ? 320 : 256);
    append(configuration_, 16);
    append(revision, 4);
    append_zeros(is_20_bits() ? 228 : 180);
    append(0x30F066012480F6, 56);
    if (is_20_bits()) append(0x9055, 16);
  }

  std::array<bool, 1280> bits_{};
  std::size_t at_ = 0;
  unsigned configuration_ = 0;
  unsigned shifted_ = 0;
  int settings_clocks_ = 0;
};

}  // namespace

std::unique_ptr<ChipEmulator> emulate_ddc264() {
  return std::make_unique<Ddc264Emulator>();
}

}  // namespace compueye::frontend
