#pragma once

#include <cstdint>

#include "firmware/pipeline/block_queue.hpp"
#include "hal/accounting.hpp"

namespace compueye::firmware {

/// The books of a stage that writes into `out`: `own` holds what it took in and dropped itself, `pushed` what it handed
/// to its queue, and it answers for what the queue then dropped. Counted apart, so that a frame lost in between shows.
template <class Slot>
[[nodiscard]] hal::FrameAccount with_queue(hal::FrameAccount own, std::uint64_t pushed,
                                           const BlockQueue<Slot>& out) noexcept {
  own.drops(hal::DropReason::superseded) += out.superseded();
  own.drops(hal::DropReason::stopped) += out.discarded();
  own.delivered = pushed - out.superseded() - out.discarded();
  return own;
}

}  // namespace compueye::firmware
