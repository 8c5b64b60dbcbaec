#include "recon/core/frame/frozen_frame.hpp"

namespace compueye::recon::core {

Thawed FrozenReader::begin(std::string_view method) noexcept {
  if (bits() != frozen_magic) return Thawed::foreign;
  if (bits() != frozen_version) return Thawed::other_version;
  if (bits() != size_) return Thawed::damaged;
  bool same = true;
  for (std::size_t word = 0; word < frozen_name_words; ++word) same = bits() == frozen_name_word(method, word) && same;
  if (!whole_) return Thawed::damaged;
  return same ? Thawed::ready : Thawed::other_method;
}

std::uint64_t FrozenReader::bits() noexcept {
  whole_ = whole_ && size_ >= sizeof(std::uint64_t) && at_ <= size_ - sizeof(std::uint64_t);
  if (!whole_) return 0;
  std::uint64_t value = 0;
  for (std::size_t k = 0; k < sizeof value; ++k) value |= std::to_integer<std::uint64_t>(bytes_[at_ + k]) << (8 * k);
  at_ += sizeof value;
  return value;
}

const std::byte* FrozenReader::take(std::size_t count, std::size_t element_size) noexcept {
  const std::uint64_t stored = bits();
  if (stored == 0) return nullptr;
  at_ = (at_ + frozen_alignment - 1) / frozen_alignment * frozen_alignment;
  whole_ = whole_ && stored == count && at_ <= size_ && count <= (size_ - at_) / element_size;
  if (!whole_) return nullptr;
  const std::byte* table = bytes_ + at_;
  at_ += count * element_size;
  return table;
}

std::size_t differing_pixels(const float* one, const float* other, std::size_t n) noexcept {
  std::size_t count = 0;
  for (std::size_t k = 0; k < n; ++k) {
    if (std::bit_cast<std::uint32_t>(one[k]) != std::bit_cast<std::uint32_t>(other[k])) ++count;
  }
  return count;
}

}  // namespace compueye::recon::core
