#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sim/render/optics_as_built.hpp"
#include "sim/render/render_settings.hpp"
#include "sim/scene/scene.hpp"

namespace compueye::sim {

/// One frame on its way from light to codes.
struct FrameInWork {
  std::uint64_t frame = 0;
  double t_s = 0.0;              ///< start of its exposure, seconds after frame 0; goes on where the scene begins anew
  std::span<double> levels_lsb;  ///< M levels, unrounded, changed in place
  std::span<std::int32_t> stuck_codes;  ///< M; >= 0: this code is read whatever the level says
};

/// What an effect does in every frame. Neither allocates nor throws; draws from streams of its own name only, so that
/// it has the same bits whatever else is on.
class FrameStep {
 public:
  FrameStep() = default;
  FrameStep(const FrameStep&) = delete;
  FrameStep& operator=(const FrameStep&) = delete;
  virtual ~FrameStep() = default;
  virtual void apply(FrameInWork& frame) noexcept = 0;
};

/// When a frame looks: the renders of the scene that it is made of.
struct Exposure {
  int instants = 1;               ///< renders over the integration time, averaged; 1: its middle
  bool channels_in_turn = false;  ///< each channel at its own time of the scan, between renders at scan_instants times
  int scan_instants = 2;
};

/// What is to be done for the planned effects and nothing else. Steps run in this order; levels are LSB above nought
/// before the dark level, then codes.
struct Workings {
  std::uint64_t seed = 0;
  /// What is rendered. Begins as given, the pictures of what is lit times Light::level; what light, display and
  /// spectrum do to a picture is done to it here, once.
  Scene scene;
  OpticsAsBuilt optics;   ///< begins as drawn
  RenderSettings render;  ///< begins with everything off
  Exposure exposure;
  std::vector<std::unique_ptr<FrameStep>> steps;
};

}  // namespace compueye::sim
