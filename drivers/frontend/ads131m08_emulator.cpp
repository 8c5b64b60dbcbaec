#include <algorithm>
#include <array>

#include "drivers/frontend/ads131m08.hpp"
#include "drivers/frontend/chip_emulator.hpp"

namespace compueye::frontend {
namespace {

constexpr std::size_t clocks_of_frame = 240;  // SBAS950 section 8.5.1.7: ten words of 24 bits

/// SBAS950 sections 8.5 and 8.6. Words are always 24 bits long; reading more than one register at once, STANDBY, LOCK,
/// a CRC of what comes in and the store of two conversions are missing.
class Ads131m08Emulator final : public ChipEmulator {
 public:
  explicit Ads131m08Emulator(std::uint16_t id) noexcept : id_(id) { start(); }

  void power_on() noexcept override {
    start();
    listening_ = false;
  }
  void reset_pin() noexcept override { start(); }

  void select() noexcept override {
    listening_ = true;
    clocks_ = 0;
    in_.fill(false);
    fill_frame();
    ready_ = 0;
  }

  bool clock(bool in) noexcept override {
    if (!listening_ || clocks_ >= clocks_of_frame) return false;
    in_[clocks_] = in;
    return out_[clocks_++];
  }

  void release() noexcept override {
    if (listening_ && clocks_ >= 24) carry_out(in_word(0));
    listening_ = false;
  }

  void convert(std::span<const std::int32_t> codes) noexcept override {
    std::copy_n(codes.begin(), codes_.size(), codes_.begin());
    ready_ |= registers_[0x03] >> 8U;
  }

 private:
  /// The values after reset in the register map; the first answer is that to a reset.
  void start() noexcept {
    registers_.fill(0);
    registers_[0x00] = id_;
    registers_[0x02] = 0x0510;
    registers_[0x03] = 0xFF0E;
    registers_[0x06] = 0x0600;
    answer_ = 0xFF28;
    answers_status_ = false;
    ready_ = 0;
  }

  /// LOCK, F_RESYNC, REG_MAP and CRC_ERR are never set; CRC_TYPE, RESET and WLENGTH are MODE's.
  [[nodiscard]] unsigned status() const noexcept { return (registers_[0x02] & 0x0F00U) | ready_; }

  void append(std::size_t& at, unsigned value, unsigned bits) noexcept {
    while (bits-- > 0) out_[at++] = (value >> bits & 1U) != 0;
  }

  /// Sections 8.5.1.7 and 8.5.1.8, the CRC bit by bit: x^16 + x^12 + x^5 + 1 from FFFFh on.
  void fill_frame() noexcept {
    std::size_t at = 0;
    append(at, (answers_status_ ? status() : answer_) << 8U, 24);
    for (const std::int32_t code : codes_) append(at, static_cast<unsigned>(code - 0x800000), 24);
    unsigned crc = 0xFFFF;
    for (std::size_t k = 0; k < at; ++k) {
      const bool carry = ((crc & 0x8000U) != 0) != out_[k];
      crc = (crc << 1U & 0xFFFFU) ^ (carry ? 1U << 12U | 1U << 5U | 1U : 0U);
    }
    append(at, crc << 8U, 24);
  }

  [[nodiscard]] unsigned in_word(std::size_t index) const noexcept {
    unsigned value = 0;
    for (std::size_t bit = 0; bit < 16; ++bit) value = value << 1U | (in_[24 * index + bit] ? 1U : 0U);
    return value;
  }

  void carry_out(unsigned command) noexcept {
    const unsigned address = command >> 7U & 0x3FU, more = command & 0x7FU;
    answers_status_ = false;
    if (command == 0x0011 && clocks_ == clocks_of_frame) {
      start();
    } else if (command >> 13U == 5 && more == 0) {
      answer_ = address == 0x01 ? status() : registers_[address];
    } else if (command >> 13U == 3) {
      unsigned written = 0;
      while (written <= more && 24 * (written + 2) <= clocks_ && written < 8) {
        write(address + written, in_word(1 + written));
        ++written;
      }
      answer_ = 0x4000U | address << 7U | (written == 0 ? 0 : written - 1);
    } else {
      answers_status_ = true;
    }
  }

  void write(unsigned address, unsigned value) noexcept {
    if (address < 0x02 || address > 0x3F) return;
    if (address == 0x02) value &= registers_[0x02] | ~0x0400U;  // RESET is cleared, and not set, by writing
    registers_[address] = value & 0xFFFFU;
  }

  unsigned id_;
  std::array<unsigned, 64> registers_{};
  std::array<std::int32_t, 8> codes_{};
  std::array<bool, clocks_of_frame> in_{}, out_{};
  unsigned answer_ = 0;
  bool answers_status_ = false;
  unsigned ready_ = 0;
  bool listening_ = false;
  std::size_t clocks_ = 0;
};

}  // namespace

std::unique_ptr<ChipEmulator> emulate_ads131m08(std::uint16_t id) {
  return std::make_unique<Ads131m08Emulator>(id);
}

}  // namespace compueye::frontend
