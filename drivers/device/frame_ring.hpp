#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <vector>

#include "hal/accounting.hpp"
#include "hal/sample_block.hpp"

namespace compueye::device {

/// What a source says of itself at one moment.
struct SourceBooks {
  hal::FrameAccount account;
  std::uint64_t outages = 0;
  bool withheld = false;
};

/// A copy of a frame on its way from a device's thread to its reader.
struct RingFrame {
  std::vector<std::int32_t> codes;
  std::vector<std::uint8_t> valid;
  hal::SampleBlock block;  ///< its spans are `codes` and `valid`
  SourceBooks books;       ///< when it had been read
};

/// A bounded queue between one thread that reads a device and one that asks for its frames. Its slots are made once and
/// go round: nothing is allocated after construction, and the lock is held for a few instructions only.
class FrameRing {
 public:
  /// So many slots, of which one is in the reader's hand; at least one.
  FrameRing(std::size_t slots, std::size_t channels);
  FrameRing(const FrameRing&) = delete;
  FrameRing& operator=(const FrameRing&) = delete;
  ~FrameRing() = default;

  // Device's thread:
  [[nodiscard]] bool has_room() noexcept;
  /// While there is room. False: the block is of another number of channels, and was not taken.
  [[nodiscard]] bool push(const hal::SampleBlock& block, const SourceBooks& books) noexcept;

  // Reader:
  /// The oldest frame, valid until the next pop(); null: there is none.
  [[nodiscard]] const RingFrame* pop() noexcept;
  /// Whether pop() would give one.
  [[nodiscard]] bool has_frame() noexcept;

  /// Empties it. Only while neither uses it.
  void clear() noexcept;

 private:
  std::mutex mutex_;
  std::vector<RingFrame> slots_;
  std::uint64_t pushed_ = 0, popped_ = 0;
  std::uint64_t released_ = 0;  // of the popped ones, those that the reader is done with
};

}  // namespace compueye::device
