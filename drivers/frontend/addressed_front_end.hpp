#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

#include "drivers/frontend/front_end.hpp"

namespace compueye::frontend {

/// Chips beside one another, each spoken to by itself and in the same way: all but what their bytes mean.
class AddressedFrontEnd : public FrontEnd {
 public:
  [[nodiscard]] int channels() const noexcept final { return row_.channels * chips_; }
  [[nodiscard]] hal::Result<void> configure(const Wiring& wiring, hal::Clock& clock) final;
  [[nodiscard]] std::span<const Exchange> frame() const noexcept final { return exchanges_; }
  [[nodiscard]] FrameReport decode(std::span<std::int32_t> codes, std::span<std::uint8_t> valid) noexcept final;

 protected:
  /// `out`: what a frame sends to a chip, a segment a row, with chip select up behind each.
  AddressedFrontEnd(const FrontEndRow& row, int chips, std::initializer_list<std::vector<std::byte>> out);

  /// Before any chip is spoken to, where a reset line is wired. It is low when the wires have just been opened.
  [[nodiscard]] virtual hal::Result<void> reset_pin(hal::OutputLines& /*line*/, hal::Clock& /*clock*/) { return {}; }
  /// Of the chip that `wiring.select` has chosen.
  [[nodiscard]] virtual hal::Result<void> configure_chip(hal::SpiBus& bus, hal::Clock& clock, int chip) = 0;
  /// Of bytes that are neither all zeros nor all ones; all of `codes` are set where there is no fault.
  [[nodiscard]] virtual ChipFault decode_chip(std::span<const std::byte> in,
                                              std::span<std::int32_t> codes) const noexcept = 0;

  [[nodiscard]] const FrontEndRow& row() const noexcept { return row_; }
  /// The segments of a frame to this chip, and what the last one brought.
  [[nodiscard]] std::span<const hal::SpiSegment> segments_of(int chip) const noexcept;
  [[nodiscard]] std::span<const std::byte> bytes_of(int chip) const noexcept;

 private:
  const FrontEndRow& row_;
  int chips_;
  std::size_t bytes_ = 0;  ///< of a chip and frame
  std::vector<std::vector<std::byte>> out_;
  std::vector<std::byte> in_;
  std::vector<hal::SpiSegment> segments_;
  std::vector<Exchange> exchanges_;
};

}  // namespace compueye::frontend
