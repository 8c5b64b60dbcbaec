#include "firmware/pipeline/acquire_stage.hpp"

#include <exception>
#include <string>
#include <utility>

#include "firmware/pipeline/stage_account.hpp"

namespace compueye::firmware {

void AcquireStage::run() noexcept {
  while (!control_.stop_seen()) {
    RawSlot* const slot = out_.claim();
    if (slot == nullptr) break;
    const std::int64_t begin_ns = clock_.now_ns();
    beat_.begins(begin_ns);
    hal::Result<hal::SampleBlock> block = read_source(begin_ns + settings_.read_timeout_ns);
    const std::int64_t end_ns = clock_.now_ns();
    beat_.ends(end_ns);
    if (block) {
      take(*block, *slot, end_ns);
    } else if (!goes_on_after(block.error(), end_ns - begin_ns)) {
      break;
    }
  }
  out_.close();
}

/// Recovery allocates. The words fit an empty string.
hal::Result<hal::SampleBlock> AcquireStage::read_source(std::int64_t deadline_ns) noexcept {
  try {
    return source_.read(deadline_ns);
  } catch (const std::exception&) {
    return hal::fail(hal::ErrorCode::no_space, "source", "out of memory");
  }
}

void AcquireStage::take(const hal::SampleBlock& block, RawSlot& slot, std::int64_t received_ns) noexcept {
  ++own_.produced;
  silent_ns_ = 0;
  if (block.flags.overrun) ++overrun_flags_;
  if (block.flags.dark) ++dark_frames_;
  if (!block.flags.time_ok) ++untrusted_times_;
  slot.assign(block, {.frame = block.frame,
                      .t_ns = block.t_ns,
                      .exposed_at_ns = device_time_.exposure_start_ns(block, received_ns),
                      .received_at_ns = received_ns});
  if (out_.push()) {
    ++pushed_;
  } else {
    ++own_.drops(hal::DropReason::stopped);
  }
}

bool AcquireStage::goes_on_after(hal::Error& error, std::int64_t waited_ns) noexcept {
  switch (error.code) {
    case hal::ErrorCode::timeout:
      if (source_.withheld()) {
        silent_ns_ = 0;
        return true;
      }
      ++read_timeouts_;
      if (source_.recovering()) {
        recovering_ns_ += waited_ns;
        silent_ns_ = 0;
        return true;
      }
      silent_ns_ += waited_ns;
      if (settings_.silence_limit_ns == 0 || silent_ns_ < settings_.silence_limit_ns) return true;
      control_.end_input({hal::ErrorCode::timeout, source_.describe().serial,
                          "no frame came for " + std::to_string(silent_ns_ / 1'000'000) +
                              " ms, the limit of silence; is the eye powered and its frame clock running?"});
      return false;
    case hal::ErrorCode::end_of_stream:
      return false;
    case hal::ErrorCode::interrupted:
      control_.end_now(Ending::stop_requested);
      return false;
    default:
      control_.end_input(std::move(error));
      return false;
  }
}

hal::FrameAccount AcquireStage::account() const noexcept {
  return with_queue(own_, pushed_, out_);
}

}  // namespace compueye::firmware
