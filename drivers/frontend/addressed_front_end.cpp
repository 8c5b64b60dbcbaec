#include "drivers/frontend/addressed_front_end.hpp"

#include <algorithm>

#include "drivers/frontend/chip_checks.hpp"
#include "hal/try.hpp"

namespace compueye::frontend {

AddressedFrontEnd::AddressedFrontEnd(const FrontEndRow& row, int chips,
                                     std::initializer_list<std::vector<std::byte>> out)
    : row_(row), chips_(chips), out_(out) {
  for (const auto& bytes : out_) bytes_ += bytes.size();
  const auto count = static_cast<std::size_t>(chips);
  in_.resize(bytes_ * count);
  std::size_t at = 0;
  for (std::size_t chip = 0; chip < count; ++chip) {
    for (const auto& bytes : out_) {
      segments_.push_back({.out = bytes, .in = std::span(in_).subspan(at, bytes.size()), .release = true});
      at += bytes.size();
    }
  }
  for (int chip = 0; chip < chips; ++chip) {
    exchanges_.push_back({.select = static_cast<std::uint32_t>(chip), .segments = segments_of(chip)});
  }
}

std::span<const hal::SpiSegment> AddressedFrontEnd::segments_of(int chip) const noexcept {
  return std::span(segments_).subspan(static_cast<std::size_t>(chip) * out_.size(), out_.size());
}

std::span<const std::byte> AddressedFrontEnd::bytes_of(int chip) const noexcept {
  return std::span(in_).subspan(static_cast<std::size_t>(chip) * bytes_, bytes_);
}

hal::Result<void> AddressedFrontEnd::configure(const Wiring& wiring, hal::Clock& clock) {
  if (wiring.reset != nullptr) TRY(reset_pin(*wiring.reset, clock));
  for (int chip = 0; chip < chips_; ++chip) {
    TRY(select_chip(wiring, row_.name, chip));
    TRY(configure_chip(*wiring.data, clock, chip));
  }
  return {};
}

FrameReport AddressedFrontEnd::decode(std::span<std::int32_t> codes, std::span<std::uint8_t> valid) noexcept {
  FrameReport report;
  const auto channels = static_cast<std::size_t>(row_.channels);
  for (int chip = 0; chip < chips_; ++chip) {
    const auto in = bytes_of(chip);
    const auto at = static_cast<std::size_t>(chip) * channels;
    const auto own = codes.subspan(at, channels);
    const ChipFault fault = all_are(in, std::byte{0})      ? ChipFault::stuck_low
                            : all_are(in, std::byte{0xFF}) ? ChipFault::stuck_high
                                                           : decode_chip(in, own);
    ++report.chips[static_cast<std::size_t>(fault)];
    const bool good = fault == ChipFault::none;
    if (!good) std::fill(own.begin(), own.end(), 0);
    const auto flags = valid.subspan(at, channels);
    std::fill(flags.begin(), flags.end(), good ? std::uint8_t{1} : std::uint8_t{0});
  }
  return report;
}

}  // namespace compueye::frontend
