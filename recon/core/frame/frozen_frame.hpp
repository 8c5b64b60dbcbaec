#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>

#include "recon/core/frame/frame_problem.hpp"
#include "recon/core/frame/frozen_layout.hpp"

namespace compueye::recon::core {

/// The samples of one frame and the picture that they gave where it was set up.
struct FrozenSamples {
  const float* y = nullptr;        ///< problem.channels
  const float* weights = nullptr;  ///< problem.channels, or null: all one
  const float* picture = nullptr;  ///< problem.pixels()
  double objective = 0.0;          ///< of that picture
};

/// A set-up problem of one method, and a frame of it: what another processor needs to give the same picture, bit for
/// bit, without a set-up of its own. In its bytes (made by Reconstructor::freeze()) numbers take eight bytes and tables
/// start at multiples of 64, little-endian: they can be used where they lie, in a file read to memory or in flash.
template <class Problem>
struct FrozenFrame {
  Problem problem;
  FrozenSamples samples;
};

enum class Thawed : std::uint8_t {
  ready,
  foreign,        ///< does not begin as a frozen frame does
  other_version,  ///< frozen by another version of this program, to be frozen again
  other_method,   ///< of another solver than the one that is asked for
  damaged,        ///< cut short, too long, or a table of another size than the problem's numbers say
};

/// Takes what describe() asks for from bytes that it never leaves; whatever is not there leaves it broken.
class FrozenReader {
 public:
  FrozenReader(const std::byte* bytes, std::size_t size) noexcept : bytes_(bytes), size_(size) {}

  /// Reads what comes before the tables; ready when they are those of `method`.
  [[nodiscard]] Thawed begin(std::string_view method) noexcept;

  template <class Number>
  void number(Number& value) noexcept {
    if constexpr (std::is_floating_point_v<Number>) {
      value = static_cast<Number>(std::bit_cast<double>(bits()));
    } else {
      value = static_cast<Number>(bits());
    }
  }
  template <class Kind>
  void kind(Kind& value) noexcept {
    value = static_cast<Kind>(bits());
  }

  template <class N>
  void table(const N*& values, std::size_t count) noexcept {
    values = reinterpret_cast<const N*>(take(count, sizeof(N)));
  }

  [[nodiscard]] bool read_all() const noexcept { return whole_ && at_ == size_; }

 private:
  [[nodiscard]] std::uint64_t bits() noexcept;
  /// Where a table of that many elements lies; null for one that is not there, or is not whole.
  [[nodiscard]] const std::byte* take(std::size_t count, std::size_t element_size) noexcept;

  const std::byte* bytes_;
  std::size_t size_;
  std::size_t at_ = 0;
  bool whole_ = true;
};

/// Points `frame` into `bytes`, which are aligned to 64 and outlive it.
template <class Problem>
[[nodiscard]] Thawed thaw(const std::byte* bytes, std::size_t size, FrozenFrame<Problem>& frame) noexcept {
  FrozenReader reader(bytes, size);
  if (const Thawed begun = reader.begin(Problem::method); begun != Thawed::ready) return begun;
  describe(frame.problem, frame.samples, reader);
  return reader.read_all() ? Thawed::ready : Thawed::damaged;
}

/// How many of the first n pixels have other bits in one picture than in the other.
[[nodiscard]] std::size_t differing_pixels(const float* one, const float* other, std::size_t n) noexcept;

}  // namespace compueye::recon::core
