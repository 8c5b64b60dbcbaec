#include "recon/freeze.hpp"

#include <bit>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <utility>

#include "recon/core/parts/frozen_layout.hpp"

namespace compueye::recon {
namespace {

class Writer {
 public:
  void bits(std::uint64_t value) {
    for (int shift = 0; shift < 64; shift += 8) bytes_.push_back(static_cast<std::byte>(value >> shift));
  }

  template <std::integral N>
  void number(N value) {
    bits(static_cast<std::uint64_t>(value));
  }
  template <std::floating_point N>
  void number(N value) {
    bits(std::bit_cast<std::uint64_t>(static_cast<double>(value)));
  }
  template <class Kind>
  void kind(Kind value) {
    bits(static_cast<std::uint64_t>(value));
  }

  template <class N>
  void table(const N* values, std::size_t count) {
    static_assert(std::endian::native == std::endian::little);
    bits(values == nullptr ? 0 : count);
    if (values == nullptr || count == 0) return;
    bytes_.resize((bytes_.size() + core::frozen_alignment - 1) / core::frozen_alignment * core::frozen_alignment);
    const auto start = bytes_.size();
    bytes_.resize(start + count * sizeof(N));
    std::memcpy(bytes_.data() + start, values, count * sizeof(N));
  }

  [[nodiscard]] std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

}  // namespace

std::vector<std::byte> freeze(core::FrozenFrame frame) {
  Writer writer;
  writer.bits(core::frozen_magic);
  writer.bits(core::frozen_version);
  writer.bits(0);  // the size, when it is known
  core::describe(frame, writer);
  std::vector<std::byte> bytes = writer.take();
  const std::uint64_t size = bytes.size();
  std::memcpy(bytes.data() + 2 * sizeof size, &size, sizeof size);
  return bytes;
}

}  // namespace compueye::recon
