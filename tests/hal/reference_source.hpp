#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "hal/clock.hpp"
#include "hal/sample_source.hpp"

namespace compueye::hal::tests {

/// The smallest live source that keeps the whole contract, with faults to inject. It holds one frame: what a slow
/// reader does not fetch in time is an overrun.
class ReferenceSource : public SampleSource {
 public:
  static constexpr int channels = 12;
  static constexpr int bits = 10;
  static constexpr std::int64_t period_ns = 1'000'000;

  explicit ReferenceSource(Clock& clock, std::optional<std::uint64_t> length = std::nullopt)
      : clock_(clock), length_(length), codes_(channels), valid_(channels) {
    description_.backend = "reference";
    description_.serial = "reference-1";
    description_.firmware = "1.0";
    description_.channels = channels;
    description_.bits = bits;
    description_.frame_rate_hz = 1e9 / static_cast<double>(period_ns);
    for (int c = 0; c < channels; ++c) description_.ommatidium_of_channel.push_back((c * 5) % channels);
  }

  void lose_frames(int frames) { to_lose_ = static_cast<std::uint64_t>(frames); }
  void lose_channel(int channel) { missing_ = channel; }
  void disconnect() { connected_ = false; }

 protected:
  SourceDescription description_;
  Clock& clock_;
  std::optional<std::uint64_t> length_;
  std::vector<std::int32_t> codes_;
  std::vector<std::uint8_t> valid_;
  FrameAccount account_;
  std::int64_t began_ns_ = 0;
  std::uint64_t next_ = 0;
  std::uint64_t to_lose_ = 0;
  int missing_ = -1;
  bool connected_ = true;

  [[nodiscard]] std::int64_t complete_at_ns(std::uint64_t frame) const {
    return began_ns_ + (static_cast<std::int64_t>(frame) + 1) * period_ns;
  }
  void lose(std::uint64_t frames, DropReason reason) {
    next_ += frames;
    account_.produced += frames;
    account_.drops(reason) += frames;
  }

  const SourceDescription& do_describe() const noexcept override { return description_; }
  Result<void> do_start() override {
    account_ = {};
    next_ = 0;
    began_ns_ = clock_.now_ns();
    return {};
  }
  void do_stop() noexcept override {}
  FrameAccount do_account() const noexcept override { return account_; }

  Result<SampleBlock> do_read(std::int64_t deadline_ns) override {
    if (!connected_) return fail(ErrorCode::disconnected, description_.serial, "the eye was unplugged");
    if (to_lose_ > 0) {
      lose(to_lose_, DropReason::transport_gap);
      to_lose_ = 0;
    }
    bool overrun = false;
    const std::int64_t now_ns = clock_.now_ns();
    if (!length_ && now_ns > complete_at_ns(next_)) {
      const auto newest = static_cast<std::uint64_t>((now_ns - began_ns_) / period_ns - 1);
      overrun = newest > next_;
      if (overrun) lose(newest - next_, DropReason::device_overrun);
    }
    if (length_ && next_ >= *length_) return stream_ended();
    if (complete_at_ns(next_) > deadline_ns) {
      clock_.sleep_until_ns(deadline_ns);
      return timed_out();
    }
    clock_.sleep_until_ns(complete_at_ns(next_));
    return make_block(overrun);
  }

  virtual SampleBlock make_block(bool overrun) {
    for (std::size_t c = 0; c < codes_.size(); ++c) {
      codes_[c] = static_cast<std::int32_t>((next_ * 3 + c) % (1U << bits));
      valid_[c] = static_cast<int>(c) == missing_ ? 0 : 1;
    }
    SampleBlock block;
    block.codes = codes_;
    block.valid = valid_;
    block.bits = bits;
    block.frame = next_;
    block.t_ns = began_ns_ + static_cast<std::int64_t>(next_) * period_ns;
    block.flags.overrun = overrun;
    ++next_;
    ++account_.produced;
    ++account_.delivered;
    return block;
  }
};

}  // namespace compueye::hal::tests
