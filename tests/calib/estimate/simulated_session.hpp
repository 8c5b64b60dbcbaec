#pragma once

#include <cstdint>
#include <vector>

#include "calib/estimate/captures.hpp"
#include "tests/calib/estimate/built_eye.hpp"

namespace compueye::test {

/// What happens between the patterns and the eye, and when captures are taken.
struct SessionSettings {
  double drift = 0.0;        ///< of the lamp, from the first capture to the last; and a fifth of it to and fro
  double gamma = 1.0;        ///< of the display
  double black_level = 0.0;  ///< of the display
  int reference_every = 16;  ///< patterns; 0: none
  int dark_every = 64;       ///< patterns; 0: none, and the dark level is told as the mean of 64 frames
  int held_out_every = 5;    ///< patterns
  int frames = 1;            ///< averaged in each capture
  bool shot = false;         ///< 2e4 electrons at full scale
  std::uint64_t seed = 5;
};

struct Session {
  calib::Captures captures;
  calib::CodeNoise noise;
};

/// Shows the patterns (P x pixels) to the eye whose rows are known: light by its rows, codes by the simulation's own
/// detector. `board` with the sensor of the session.
[[nodiscard]] hal::Result<Session> simulated_session(sim::EyeToSimulate board, const PixelResponses& eye,
                                                     std::vector<float> patterns, const SessionSettings& settings);

/// How far a row is from the true one, relative to its norm: columns and values as of a RowEstimate.
[[nodiscard]] double relative_row_error(const double* truth, int pixels, const std::vector<std::int32_t>& columns,
                                        const std::vector<float>& values);

}  // namespace compueye::test
