#include "firmware/calibration/ommatidium_order.hpp"

#include <cstddef>
#include <numeric>

namespace compueye::firmware {

OmmatidiumOrder::OmmatidiumOrder(const hal::SourceDescription& source) {
  const auto& map = source.ommatidium_of_channel;
  std::vector<std::int32_t> order(map.size());
  std::iota(order.begin(), order.end(), 0);
  if (map != order) map_ = map;
  codes_.resize(map_.size());
  valid_.resize(map_.size());
}

hal::SampleBlock OmmatidiumOrder::ordered(const hal::SampleBlock& block) noexcept {
  if (map_.empty()) return block;
  for (std::size_t c = 0; c < map_.size(); ++c) {
    const auto m = static_cast<std::size_t>(map_[c]);
    codes_[m] = block.codes[c];
    valid_[m] = block.valid[c];
  }
  hal::SampleBlock made = block;
  made.codes = codes_;
  made.valid = valid_;
  return made;
}

}  // namespace compueye::firmware
