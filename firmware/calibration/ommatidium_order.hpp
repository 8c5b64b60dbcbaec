#pragma once

#include <cstdint>
#include <vector>

#include "hal/sample_block.hpp"
#include "hal/sample_source.hpp"

namespace compueye::firmware {

/// Puts the channels of frames into the order of the ommatidia that they are wired to.
class OmmatidiumOrder {
 public:
  /// The source's map from channels to ommatidia is a permutation.
  explicit OmmatidiumOrder(const hal::SourceDescription& source);

  /// Valid as long as `block`, and until the next one.
  [[nodiscard]] hal::SampleBlock ordered(const hal::SampleBlock& block) noexcept;

 private:
  std::vector<std::int32_t> map_;  // empty: they are in order
  std::vector<std::int32_t> codes_;
  std::vector<std::uint8_t> valid_;
};

}  // namespace compueye::firmware
