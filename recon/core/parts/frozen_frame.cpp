#include "recon/core/parts/frozen_frame.hpp"

#include <bit>
#include <concepts>

#include "recon/core/parts/frozen_layout.hpp"

namespace compueye::recon::core {
namespace {

/// Takes what describe() asks for from bytes that it never leaves; whatever is not there leaves it broken.
class Reader {
 public:
  Reader(const std::byte* bytes, std::size_t size) noexcept : bytes_(bytes), size_(size) {}

  template <std::integral N>
  void number(N& value) noexcept {
    value = static_cast<N>(bits());
  }
  template <std::floating_point N>
  void number(N& value) noexcept {
    value = static_cast<N>(std::bit_cast<double>(bits()));
  }
  template <class Kind>
  void kind(Kind& value) noexcept {
    value = static_cast<Kind>(bits());
  }

  template <class N>
  void table(const N*& values, std::size_t count) noexcept {
    values = nullptr;
    const std::uint64_t stored = bits();
    if (stored == 0) return;
    at_ = (at_ + frozen_alignment - 1) / frozen_alignment * frozen_alignment;
    if (stored != count || at_ > size_ || count > (size_ - at_) / sizeof(N)) {
      whole_ = false;
      return;
    }
    values = reinterpret_cast<const N*>(bytes_ + at_);
    at_ += count * sizeof(N);
  }

  [[nodiscard]] std::uint64_t bits() noexcept {
    whole_ = whole_ && size_ >= sizeof(std::uint64_t) && at_ <= size_ - sizeof(std::uint64_t);
    if (!whole_) return 0;
    std::uint64_t value = 0;
    for (std::size_t k = 0; k < sizeof value; ++k) value |= std::to_integer<std::uint64_t>(bytes_[at_ + k]) << (8 * k);
    at_ += sizeof value;
    return value;
  }

  [[nodiscard]] bool read_all() const noexcept { return whole_ && at_ == size_; }

 private:
  const std::byte* bytes_;
  std::size_t size_;
  std::size_t at_ = 0;
  bool whole_ = true;
};

}  // namespace

Thawed thaw(const std::byte* bytes, std::size_t size, FrozenFrame& frame) noexcept {
  Reader reader(bytes, size);
  if (reader.bits() != frozen_magic) return Thawed::foreign;
  if (reader.bits() != frozen_version) return Thawed::other_version;
  if (reader.bits() != size) return Thawed::damaged;
  describe(frame, reader);
  return reader.read_all() ? Thawed::ready : Thawed::damaged;
}

std::size_t differing_pixels(const FrozenFrame& frame, const float* x) noexcept {
  std::size_t count = 0;
  for (std::size_t k = 0; k < frame.problem.pixels(); ++k) {
    if (std::bit_cast<std::uint32_t>(x[k]) != std::bit_cast<std::uint32_t>(frame.picture[k])) ++count;
  }
  return count;
}

}  // namespace compueye::recon::core
