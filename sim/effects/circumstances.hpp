#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "hal/build_settings.hpp"
#include "hal/detector_settings.hpp"
#include "hal/eye_geometry.hpp"
#include "hal/sensor_settings.hpp"
#include "sim/scene/scene.hpp"

namespace compueye::sim {

/// The eye to be simulated: its drawing, and how it was built.
struct EyeToSimulate {
  hal::EyeGeometry eye;
  hal::ObjectPlane object;
  hal::BuildSettings build;
  hal::SensorSettings sensor;
  hal::DetectorSettings detector;
  double frame_rate_hz = 100.0;  ///< of the device, > 0, whether or not anybody waits for it

  [[nodiscard]] double period_s() const noexcept { return 1.0 / frame_rate_hz; }
  /// Light is gathered so long in a frame.
  [[nodiscard]] double integration_s() const noexcept;
};

/// What a cheap look at the scene tells: the drawn eye in front of it, surfaces where they are and before each other,
/// at that of several times at which it is brightest, to a few per cent. In LSB above the dark level.
struct Preview {
  std::vector<double> levels;    ///< M
  double mean = 0.0, rms = 0.0;  ///< over the channels
  double largest = 0.0;          ///< of all levels
  double neighbour_rms = 0.0;    ///< of a level minus the mean of its (up to four) neighbours
  /// d level / d (mm that the scene moves) in x and y: rms and largest over the channels, the larger of the two.
  double gradient_rms = 0.0, gradient_largest = 0.0;
  double laplacian_rms = 0.0;  ///< of the second derivative by mm, the larger of x and y
  /// Rms over channels, largest of the times, of what changes when surfaces lie flat on the object plane, do not hide
  /// each other, stand still. Absent: nobody looked, since nothing is like that.
  std::optional<double> flat_change, shine_through_change, standstill_change;
};

/// All that an effect may ask when it says whether it is called for, how large it is and what it costs.
struct Circumstances {
  const EyeToSimulate& board;
  const Scene& scene;
  const Preview& preview;
};

}  // namespace compueye::sim
