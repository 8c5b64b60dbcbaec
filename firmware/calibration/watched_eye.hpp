#pragma once

#include <cstdint>
#include <functional>

#include "firmware/calibration/ommatidium_order.hpp"
#include "hal/clock.hpp"
#include "hal/sample_source.hpp"

namespace compueye::firmware {

/// An eye as a session sees it: its frames in the order of ommatidia, whatever its channels are wired to, and with
/// patience while the source gets its device back.
class WatchedEye {
 public:
  /// Both must outlive it. The source's map from channels to ommatidia is a permutation.
  WatchedEye(hal::SampleSource& source, hal::Clock& clock);

  /// Valid until the next one. Asks `go_on` every 200 ms of waiting. Errors: those of hal::SampleSource::read() but for
  /// timeout, which is said after ten seconds without a frame in which nothing was being recovered; interrupted.
  [[nodiscard]] hal::Result<hal::SampleBlock> next(const std::function<bool()>& go_on);

  /// Whether the source lost its device or its stream since the last call.
  [[nodiscard]] bool was_lost() noexcept;

 private:
  hal::SampleSource& source_;
  hal::Clock& clock_;
  OmmatidiumOrder order_;
  std::uint64_t outages_ = 0;
};

}  // namespace compueye::firmware
