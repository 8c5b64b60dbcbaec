#include "drivers/frontend/clocked_chips.hpp"

namespace compueye::frontend {
namespace {

constexpr std::size_t bits_of_byte = 8;

}  // namespace

void ClockedChips::exchange(std::span<const hal::SpiSegment> segments, std::uint32_t address, const BusFaults& faults,
                            std::size_t& clocks) {
  bool selected = false;
  for (const hal::SpiSegment& segment : segments) {
    if (!selected) select(true, address);
    selected = true;
    for (std::size_t k = 0; k < segment.bytes(); ++k) {
      const std::byte in = byte(segment.out.empty() ? std::byte{0} : segment.out[k], address, faults, clocks);
      if (!segment.in.empty()) segment.in[k] = in;
    }
    if (segment.release) select(selected = false, address);
  }
  if (selected) select(false, address);
}

void ClockedChips::exchange_settings(std::span<const hal::SpiSegment> segments) {
  for (const hal::SpiSegment& segment : segments) {
    for (std::size_t k = 0; k < segment.bytes(); ++k) {
      const unsigned out = segment.out.empty() ? 0U : std::to_integer<unsigned>(segment.out[k]);
      for (unsigned bit = bits_of_byte; bit-- > 0;) {
        for (ChipEmulator* chip : chips_) chip->settings_clock((out >> bit & 1U) != 0);
      }
      if (!segment.in.empty()) segment.in[k] = std::byte{0xFF};
    }
  }
}

void ClockedChips::select(bool low, std::uint32_t address) noexcept {
  for (std::size_t c = 0; c < chips_.size(); ++c) {
    if (hookup_ == Hookup::addressed && c != address) continue;
    low ? chips_[c]->select() : chips_[c]->release();
  }
  line_ = true;
}

bool ClockedChips::clock(bool sent, std::uint32_t address) noexcept {
  if (hookup_ == Hookup::alone) return chips_.front()->clock(sent);
  if (hookup_ == Hookup::addressed) return address >= chips_.size() || chips_[address]->clock(sent);
  bool level = false;
  for (std::size_t c = chips_.size(); c-- > 0;) level = chips_[c]->clock(level);
  return level;
}

std::byte ClockedChips::byte(std::byte out, std::uint32_t address, const BusFaults& faults,
                             std::size_t& clocks) noexcept {
  if (faults.brown_out && clocks == bits_of_byte * *faults.brown_out) {
    chips_[faults.chip % chips_.size()]->power_on();
  }
  unsigned in = 0;
  for (unsigned bit = 0; bit < bits_of_byte; ++bit, ++clocks) {
    const bool sent = (std::to_integer<unsigned>(out) >> (bits_of_byte - 1 - bit) & 1U) != 0;
    if (faults.select_glitch == clocks) {
      select(false, address);
      select(true, address);
    }
    if (faults.lost_clock != clocks) line_ = clock(sent, address);
    const bool seen = line_ != (faults.turned_bit == clocks);
    if (faults.doubled_clock == clocks) line_ = clock(sent, address);
    in = in << 1U | (faults.stuck.value_or(seen) ? 1U : 0U);
  }
  return static_cast<std::byte>(in);
}

}  // namespace compueye::frontend
