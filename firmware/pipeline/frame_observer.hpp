#pragma once

#include <cstdint>
#include <span>

#include "hal/frame_sink.hpp"
#include "recon/core/frame/frame_info.hpp"

namespace compueye::firmware {

/// A frame that the sink has just taken. Views are valid during the call only.
struct PublishedFrame {
  const hal::Frame& frame;
  const recon::FrameInfo& info;
  std::span<const float> y;        ///< M samples by ommatidium, in units of one fully seen white pixel
  std::span<const float> weights;  ///< M weights, 0 = the sample was not used
  std::int64_t solve_ns = 0;
  std::int64_t age_ns = 0;      ///< start of exposure to now
  bool late = false;            ///< older than the deadline
  std::uint64_t delivered = 0;  ///< frames delivered in this run, this one included
};

/// Looks on, for metrics and progress. Called on the publish thread (the one that called Pipeline::run()): time spent
/// here delays the next frame.
class FrameObserver {
 public:
  FrameObserver() = default;
  FrameObserver(const FrameObserver&) = delete;
  FrameObserver& operator=(const FrameObserver&) = delete;
  virtual ~FrameObserver() = default;

  virtual void published(const PublishedFrame& frame) noexcept = 0;
};

}  // namespace compueye::firmware
