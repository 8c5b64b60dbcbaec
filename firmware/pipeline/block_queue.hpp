#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <vector>

#include "firmware/pipeline/inheriting_mutex.hpp"

namespace compueye::firmware {

/// What happens when the writer is faster than the reader.
enum class Pacing : std::uint8_t {
  newest_wins,  ///< the oldest waiting block is dropped and counted: fresh pictures, for a live eye
  every_frame,  ///< the writer waits: nothing is lost here, for recordings and demonstrations
};

/// A bounded queue between exactly one writer thread and one reader thread. Its blocks are made once, from a pattern
/// block, and go round: nothing is allocated after construction, and the lock is held for a few instructions only.
///
/// Each side has one block in its hands: the writer the one claim() gave it (a frame that is given up is simply not
/// pushed), the reader the one from its last pop().
template <class Block>
class BlockQueue {
 public:
  /// `capacity` >= 1 waiting blocks; two more are made for the hands of writer and reader.
  BlockQueue(std::size_t capacity, Pacing pacing, const Block& pattern)
      : pacing_(pacing), blocks_(capacity + 2, pattern), waiting_(capacity), free_(capacity + 2) {
    reset();
  }
  BlockQueue(const BlockQueue&) = delete;
  BlockQueue& operator=(const BlockQueue&) = delete;
  ~BlockQueue() = default;

  /// Writer: the block to fill, the same one again until it is pushed. Under every_frame it waits until there is room,
  /// so that push() never has to. nullptr after abort() or close().
  [[nodiscard]] Block* claim() noexcept {
    std::unique_lock lock(mutex_);
    if (pacing_ == Pacing::every_frame) {
      room_.wait(mutex_, [this] { return closed_ || count_ < waiting_.size(); });
    }
    if (closed_) return nullptr;
    if (writing_ == none) writing_ = free_[--free_count_];
    return &blocks_[writing_];
  }

  /// Writer: hands over the claimed block. False, and the block is given up, when the queue was closed or aborted
  /// meanwhile or nothing was claimed.
  [[nodiscard]] bool push() noexcept {
    {
      const std::lock_guard lock(mutex_);
      if (writing_ == none) return false;
      if (closed_) {
        free_[free_count_++] = writing_;
        writing_ = none;
        return false;
      }
      if (count_ == waiting_.size()) {
        free_[free_count_++] = take_oldest();
        ++superseded_;
      }
      waiting_[(first_ + count_) % waiting_.size()] = writing_;
      ++count_;
      writing_ = none;
    }
    filled_.notify_one();
    return true;
  }

  /// Reader: the oldest waiting block, valid until the next pop(); waits for one. nullptr when the queue was aborted,
  /// or closed and drained.
  [[nodiscard]] Block* pop() noexcept {
    std::unique_lock lock(mutex_);
    if (reading_ != none) {
      free_[free_count_++] = reading_;
      reading_ = none;
    }
    filled_.wait(mutex_, [this] { return closed_ || count_ > 0; });
    if (count_ == 0) return nullptr;
    reading_ = take_oldest();
    Block* const block = &blocks_[reading_];
    lock.unlock();
    room_.notify_one();
    return block;
  }

  /// No more blocks will be pushed; those waiting can still be popped. Any thread; idempotent.
  void close() noexcept {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    filled_.notify_all();
    room_.notify_all();
  }

  /// Closes and throws away what waits (counted in discarded()). Blocks already in a hand stay valid. Any thread.
  void abort() noexcept {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
      discarded_ += count_;
      while (count_ > 0) free_[free_count_++] = take_oldest();
    }
    filled_.notify_all();
    room_.notify_all();
  }

  /// Opens the queue for another run, empty and with counters at 0. Only while no thread uses it.
  void reset() noexcept {
    const std::lock_guard lock(mutex_);
    closed_ = false;
    first_ = count_ = 0;
    writing_ = reading_ = none;
    superseded_ = discarded_ = 0;
    free_count_ = free_.size();
    for (std::size_t i = 0; i < free_.size(); ++i) free_[i] = i;
  }

  /// Blocks dropped because a newer one came into a full queue.
  [[nodiscard]] std::uint64_t superseded() const noexcept {
    const std::lock_guard lock(mutex_);
    return superseded_;
  }
  /// Blocks thrown away by abort().
  [[nodiscard]] std::uint64_t discarded() const noexcept {
    const std::lock_guard lock(mutex_);
    return discarded_;
  }
  [[nodiscard]] std::size_t capacity() const noexcept { return waiting_.size(); }

 private:
  static constexpr std::size_t none = static_cast<std::size_t>(-1);

  std::size_t take_oldest() noexcept {
    const std::size_t block = waiting_[first_];
    first_ = (first_ + 1) % waiting_.size();
    --count_;
    return block;
  }

  const Pacing pacing_;
  mutable InheritingMutex mutex_;
  InheritingCondition filled_;
  InheritingCondition room_;
  std::vector<Block> blocks_;
  std::vector<std::size_t> waiting_;  // ring of indices into blocks_
  std::vector<std::size_t> free_;     // stack of indices
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  std::size_t free_count_ = 0;
  std::size_t writing_ = none;
  std::size_t reading_ = none;
  bool closed_ = false;
  std::uint64_t superseded_ = 0;
  std::uint64_t discarded_ = 0;
};

}  // namespace compueye::firmware
