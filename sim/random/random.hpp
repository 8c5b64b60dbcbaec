#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace compueye::sim {

/// Who draws. Values are part of what a seed means: append, never renumber.
enum class Draws : std::uint16_t {
  picture = 1,     ///< built-in scenes; frame = which picture, channel = which part of it
  read_noise = 2,  ///< one draw a channel and frame
};

/// Who draws by a name of its own: an effect. Two names of the list of effects give two values (tested).
[[nodiscard]] constexpr Draws draws_of(std::string_view name) noexcept {
  std::uint32_t hash = 2166136261U;  // FNV-1a
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 16777619U;
  return static_cast<Draws>(0x8000U | ((hash ^ (hash >> 16U)) & 0x7FFFU));
}

/// Names one random stream. Two keys that differ anywhere give independent streams, so switching one effect, skipping
/// a frame or removing a channel never changes what the others draw.
struct StreamKey {
  std::uint64_t seed = 0;
  Draws draws = Draws::picture;
  std::uint64_t frame = 0;
  std::uint32_t channel = 0;
};

/// Philox4x32-10: a bijection of the 128-bit counter for each 64-bit key. Source: Salmon, Moraes, Dror and Shaw,
/// "Parallel random numbers: as easy as 1, 2, 3", SC'11 (2011), section 3.3.
[[nodiscard]] std::array<std::uint32_t, 4> philox4x32(std::array<std::uint32_t, 4> counter,
                                                      std::array<std::uint32_t, 2> key) noexcept;

/// Inverse of the normal distribution function for 0 < p < 1, relative accuracy about 1e-15. Source: Wichura,
/// "Algorithm AS 241: the percentage points of the normal distribution" (PPND16), Applied Statistics 37 (1988). Its
/// logarithm is our own, so that the result has the same bits whatever mathematics library the platform brings.
[[nodiscard]] double normal_quantile(double p) noexcept;

/// The draws of one key, in order; cheap to make, no heap. At most 2^17 draws.
class RandomStream {
 public:
  explicit RandomStream(const StreamKey& key) noexcept : key_(key) {}

  [[nodiscard]] std::uint64_t next_bits() noexcept;
  /// 0 <= u < 1, 53 bits.
  [[nodiscard]] double uniform() noexcept;
  /// lo <= u < hi.
  [[nodiscard]] double uniform(double lo, double hi) noexcept { return lo + (hi - lo) * uniform(); }
  /// An integer 0 <= k < n, n >= 1.
  [[nodiscard]] std::uint32_t below(std::uint32_t n) noexcept;
  /// Mean 0, standard deviation 1; one draw of 64 bits each.
  [[nodiscard]] double gaussian() noexcept;

 private:
  StreamKey key_;
  std::uint32_t block_ = 0;
  std::array<std::uint64_t, 2> bits_{};
  int left_ = 0;
};

}  // namespace compueye::sim
