#include "firmware/calibration/watched_eye.hpp"

#include <utility>

namespace compueye::firmware {
namespace {

constexpr std::int64_t no_frame_ns = 10'000'000'000, wait_ns = 200'000'000;

}  // namespace

WatchedEye::WatchedEye(hal::SampleSource& source, hal::Clock& clock)
    : source_(source), clock_(clock), order_(source.describe()), outages_(source.outages()) {}

hal::Result<hal::SampleBlock> WatchedEye::next(const std::function<bool()>& go_on) {
  std::int64_t waiting_since_ns = clock_.now_ns();
  for (;;) {
    auto block = source_.read(clock_.now_ns() + wait_ns);
    if (block) return order_.ordered(*block);
    if (block.error().code != hal::ErrorCode::timeout) return block;
    if (!go_on()) return hal::fail(hal::ErrorCode::interrupted, "calibrate", "was stopped");
    // It bounds that itself, and has a stream to wait for when it is over.
    if (source_.recovering()) waiting_since_ns = clock_.now_ns();
    if (clock_.now_ns() - waiting_since_ns < no_frame_ns) continue;
    return hal::fail(hal::ErrorCode::timeout, source_.describe().serial, "gave no frame for 10 s: see to its cable");
  }
}

bool WatchedEye::was_lost() noexcept {
  return std::exchange(outages_, source_.outages()) != source_.outages();
}

}  // namespace compueye::firmware
