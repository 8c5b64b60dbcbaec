#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "hal/sample_source.hpp"

namespace compueye::test {

/// An eye whose light over the dark is changed on its way, with that of a scene beside it, in LSB, both by device time.
class EyeInAScene final : public hal::SampleSource {
 public:
  using OverTime = std::function<double(std::int64_t t_ns, std::size_t m)>;
  EyeInAScene(hal::SampleSource& eye, double dark_lsb) : eye_(eye), dark_lsb_(dark_lsb) {}

  OverTime gain = [](std::int64_t, std::size_t) { return 1.0; };
  OverTime scene_lsb = [](std::int64_t, std::size_t) { return 0.0; };
  std::function<std::uint64_t(std::int64_t t_ns)> lost = [](std::int64_t) { return std::uint64_t{0}; };

 private:
  const hal::SourceDescription& do_describe() const noexcept override { return eye_.describe(); }
  hal::Result<void> do_start() override { return eye_.start(); }
  hal::Result<hal::SampleBlock> do_read(std::int64_t deadline_ns) override {
    auto block = eye_.read(deadline_ns);
    if (!block) return block;
    outages_ = lost(block->t_ns);
    codes_.assign(block->codes.begin(), block->codes.end());
    for (std::size_t m = 0; m < codes_.size(); ++m) {
      const double light = codes_[m] - dark_lsb_ + scene_lsb(block->t_ns, m);
      codes_[m] = static_cast<std::int32_t>(std::lround(dark_lsb_ + gain(block->t_ns, m) * light));
    }
    block->codes = codes_;
    return block;
  }
  void do_stop() noexcept override { eye_.stop(); }
  hal::FrameAccount do_account() const noexcept override { return eye_.account(); }
  std::uint64_t do_outages() const noexcept override { return outages_; }

  hal::SampleSource& eye_;
  double dark_lsb_;
  std::uint64_t outages_ = 0;
  std::vector<std::int32_t> codes_;
};

}  // namespace compueye::test
