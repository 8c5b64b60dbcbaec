#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <vector>

#include "hal/accounting.hpp"
#include "hal/sample_block.hpp"

namespace compueye::recording {

/// A copy of a frame on its way to the file.
struct WaitingFrame {
  std::vector<std::int32_t> codes;
  std::vector<std::uint8_t> valid;
  hal::SampleBlock block;  ///< its spans are `codes` and `valid`
  std::int64_t arrival_ns = 0;
  hal::FrameAccount account;
  std::uint64_t skipped = 0;  ///< frames so far that found no room
};

/// A bounded queue between one thread that reads an eye and one that writes a file. Its slots are made once and go
/// round: nothing is allocated after construction, and the lock is held for a few instructions only.
class WaitingFrames {
 public:
  WaitingFrames(std::size_t capacity, std::size_t channels);
  WaitingFrames(const WaitingFrames&) = delete;
  WaitingFrames& operator=(const WaitingFrames&) = delete;
  ~WaitingFrames() = default;

  /// Eye's thread: the slot to fill, nullptr when none is free; with `wait` it waits for one.
  [[nodiscard]] WaitingFrame* claim(bool wait) noexcept;
  /// Eye's thread: hands the claimed slot over.
  void push() noexcept;

  /// File's thread: the oldest waiting frame, valid until done(); waits for one until somebody calls wake(). nullptr
  /// when there is none.
  [[nodiscard]] WaitingFrame* oldest() noexcept;
  /// Any thread: the file's thread has something else to look at.
  void wake() noexcept;
  /// Nothing more will come, and everything is done().
  [[nodiscard]] bool drained() noexcept;
  /// File's thread: the oldest frame's slot may be used again.
  void done() noexcept;

  /// Nothing more will be pushed. Any thread; idempotent.
  void close() noexcept;

 private:
  std::mutex mutex_;
  std::condition_variable filled_;
  std::condition_variable room_;
  std::vector<WaitingFrame> slots_;
  std::uint64_t pushed_ = 0;
  std::uint64_t done_ = 0;
  bool closed_ = false;
  bool woken_ = false;
};

}  // namespace compueye::recording
