#pragma once

#include <memory>
#include <optional>

#include "firmware/calibration/exposure_choice.hpp"
#include "firmware/calibration/lights.hpp"
#include "firmware/eye/board.hpp"
#include "firmware/eye/source_list.hpp"
#include "hal/clock.hpp"
#include "hal/illuminator.hpp"

namespace compueye::firmware {

/// An eye that is no simulated one before a light, in real time.
struct AttachedBench {
  std::unique_ptr<hal::SampleSource> eye;
  std::optional<ExposureControl> exposure;  ///< nothing: it has none that can be set
  std::unique_ptr<hal::Illuminator> light;

  /// With the eye of the board. `clock` must outlive it. Errors: those of real_eye() and light_kind(), and of the
  /// light.
  [[nodiscard]] static hal::Result<AttachedBench> create(const Board& board, const LightWanted& wanted,
                                                         hal::Clock& clock, Person person);

  /// The same with an eye that is there.
  [[nodiscard]] static hal::Result<AttachedBench> create(BoardEye eye, const hal::ObjectPlane& plane,
                                                         const LightWanted& wanted, hal::Clock& clock, Person person,
                                                         LineLamps lamps = {});
};

}  // namespace compueye::firmware
