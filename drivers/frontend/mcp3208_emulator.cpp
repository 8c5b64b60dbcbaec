#include <algorithm>
#include <array>

#include "drivers/frontend/chip_emulator.hpp"
#include "drivers/frontend/mcp3208.hpp"

namespace compueye::frontend {
namespace {

/// DS21298E section 5.0 with figures 5-1 and 5-2, and table 5-2. Clocks are counted from the start bit.
class Mcp3208Emulator final : public ChipEmulator {
 public:
  /// Section 5.0: powered up while CS is low, CS has to go high and low again before anything is said.
  void power_on() noexcept override { listening_ = false; }
  void select() noexcept override {
    listening_ = true;
    clocks_ = -1;
    configuration_ = 0;
  }
  void release() noexcept override { listening_ = false; }

  bool clock(bool in) noexcept override {
    if (!listening_) return true;
    if (clocks_ < 0) {
      if (in) clocks_ = 0;
      return true;
    }
    ++clocks_;
    if (clocks_ <= 4) configuration_ = configuration_ << 1U | (in ? 1U : 0U);
    if (clocks_ < 6) return true;
    const int value = converted();
    if (clocks_ >= 7 && clocks_ <= 18) return (value >> (18 - clocks_) & 1) != 0;
    // Figure 5-2: more clocks give the bits again from B1 on, and then zeros.
    if (clocks_ >= 19 && clocks_ <= 29) return (value >> (clocks_ - 18) & 1) != 0;
    return false;
  }

  void convert(std::span<const std::int32_t> codes) noexcept override {
    std::copy_n(codes.begin(), codes_.size(), codes_.begin());
  }

 private:
  /// Table 5-2: SGL D2 D1 D0; without SGL the difference of two neighbours, D0 saying which one is subtracted.
  [[nodiscard]] int converted() const noexcept {
    const unsigned channel = configuration_ & 7U;
    if ((configuration_ & 8U) != 0) return codes_[channel];
    return std::max(0, codes_[channel] - codes_[channel ^ 1U]);
  }

  std::array<std::int32_t, 8> codes_{};
  bool listening_ = false;
  int clocks_ = -1;
  unsigned configuration_ = 0;
};

}  // namespace

std::unique_ptr<ChipEmulator> emulate_mcp3208() {
  return std::make_unique<Mcp3208Emulator>();
}

}  // namespace compueye::frontend
