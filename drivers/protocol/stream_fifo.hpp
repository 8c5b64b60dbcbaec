#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace compueye::protocol {

/// The memory of an emulated device: packets wait in it until the host reads them. A packet can be read from the time
/// on at which the link has carried it. Memory is made at set-up.
class StreamFifo {
 public:
  explicit StreamFifo(std::size_t bytes);

  [[nodiscard]] std::size_t capacity() const noexcept { return bytes_.size(); }
  [[nodiscard]] std::size_t used() const noexcept { return used_; }
  [[nodiscard]] bool fits(std::size_t bytes, std::size_t packets) const noexcept {
    return bytes <= bytes_.size() - used_ && packets <= entries_.size() - waiting_;
  }
  /// Appends; it has to fit.
  void push(std::span<const std::byte> packet, std::int64_t available_ns) noexcept;
  /// Takes what is available at `now_ns`, up to into.size() bytes; `one_packet`: of one packet at most, whose rest is
  /// gone.
  std::size_t read(std::int64_t now_ns, std::span<std::byte> into, bool one_packet) noexcept;
  /// When the oldest packet can be read.
  [[nodiscard]] std::optional<std::int64_t> available_ns() const noexcept;
  void clear() noexcept;
  /// Leaves only the first half of the oldest packet: the power went while it was being sent.
  void cut() noexcept;

 private:
  struct Entry {
    std::size_t bytes = 0;
    std::int64_t available_ns = 0;
  };
  void drop_front(std::size_t bytes) noexcept;

  std::vector<std::byte> bytes_;
  std::size_t begin_ = 0, used_ = 0;
  std::vector<Entry> entries_;
  std::size_t first_ = 0, waiting_ = 0;
};

}  // namespace compueye::protocol
