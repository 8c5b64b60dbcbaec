#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hal/sample_block.hpp"
#include "recon/core/frame/frame_info.hpp"

namespace compueye::firmware {

/// Which frame this is and when it happened; goes with it from stage to stage.
struct FrameStamp {
  std::uint64_t frame = 0;          ///< the source's sequence number
  std::int64_t t_ns = 0;            ///< start of exposure, device clock
  std::int64_t exposed_at_ns = 0;   ///< start of exposure, host clock
  std::int64_t received_at_ns = 0;  ///< when the source handed it over, host clock
};

/// acquire -> correct: a copy of what the source returned, because its block lives until the next read() only.
class RawSlot {
 public:
  explicit RawSlot(std::size_t channels) : codes_(channels), valid_(channels) {}

  /// A block of another size than planned is kept without its samples, for the correct stage to refuse.
  void assign(const hal::SampleBlock& block, const FrameStamp& stamp_) noexcept {
    stamp = stamp_;
    head_ = block;
    head_.codes = {};
    head_.valid = {};
    whole_ = false;
    if (block.codes.size() != codes_.size() || block.valid.size() != valid_.size()) return;
    std::copy(block.codes.begin(), block.codes.end(), codes_.begin());
    std::copy(block.valid.begin(), block.valid.end(), valid_.begin());
    whole_ = true;
  }
  [[nodiscard]] hal::SampleBlock view() const noexcept {
    hal::SampleBlock block = head_;
    if (whole_) {
      block.codes = codes_;
      block.valid = valid_;
    }
    return block;
  }

  FrameStamp stamp;

 private:
  std::vector<std::int32_t> codes_;
  std::vector<std::uint8_t> valid_;
  hal::SampleBlock head_;
  bool whole_ = false;
};

/// correct -> reconstruct: M samples by ommatidium, in units of one fully seen white pixel, and their weights.
struct CorrectedSlot {
  explicit CorrectedSlot(std::size_t channels) : y(channels), weights(channels) {}
  FrameStamp stamp;
  std::vector<float> y;
  std::vector<float> weights;
};

/// reconstruct -> publish: N pixels and what they were made from.
struct PictureSlot {
  PictureSlot(std::size_t channels, std::size_t pixels_) : pixels(pixels_), y(channels), weights(channels) {}
  FrameStamp stamp;
  recon::FrameInfo info;
  std::int64_t solve_ns = 0;
  std::vector<float> pixels;
  std::vector<float> y;
  std::vector<float> weights;
};

}  // namespace compueye::firmware
