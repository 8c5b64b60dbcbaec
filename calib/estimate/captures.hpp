#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "hal/eye_geometry.hpp"
#include "hal/result.hpp"

namespace compueye::calib {

/// Frames of one light that come back between the patterns: the whole display white (references) or the lamp off
/// (darks). Each is the mean of `frames` frames.
struct Interleaved {
  std::vector<double> time;   ///< ascending, in the unit of Captures::time
  std::vector<double> codes;  ///< time.size() x M, mean codes, LSB
  double frames = 1.0;        ///< averaged in each

  [[nodiscard]] std::size_t count() const noexcept { return time.size(); }
};

/// Straight lines between points: what a channel's code would be, were its converter straight.
struct LinearityTable {
  std::vector<double> code;      ///< ascending, LSB
  std::vector<double> straight;  ///< of each code, LSB

  /// Beyond the ends it goes on as its last piece does. Fewer than two points: the code itself.
  [[nodiscard]] double straightened(double code_lsb) const noexcept;
};

/// What a calibration session saw. P patterns of rows x cols of the object plane, M channels (the ommatidia in order).
struct Captures {
  std::vector<float> patterns;            ///< P x N: what the display was told, 0 (black) .. 1 (white)
  std::vector<double> codes;              ///< P x M, mean codes, LSB; NaN: this channel has nothing for this pattern
  std::vector<double> frames;             ///< P, averaged in each pattern's code, >= 1; empty: 1 each
  std::vector<double> time;               ///< P, when each was taken; may be empty where nothing is interleaved
  std::vector<std::uint8_t> held_out;     ///< P; not 0: judges the fit and has no part in choosing it
  Interleaved references;                 ///< may be none: then no drift is taken off
  Interleaved darks;                      ///< may be none: then dark_lsb holds
  std::vector<double> dark_lsb;           ///< M, where there are no darks; empty: 0
  std::vector<LinearityTable> linearity;  ///< M, or none: the converter is straight

  [[nodiscard]] int count(int pixels) const noexcept {
    return static_cast<int>(patterns.size() / static_cast<std::size_t>(pixels));
  }
};

/// How certain a code is, and what it is worth.
struct CodeNoise {
  double read_noise_lsb = 1.0;              ///< of one frame, > 0; rounding is added
  std::optional<double> electrons_per_lsb;  ///< > 0: shot noise; nothing: light without quanta
  double unit_lsb = 1.0;                    ///< LSB that a fully seen white pixel gives as drawn, > 0: A's unit
  double saturated_lsb = 0.0;               ///< codes from here on are saturated, before linearity; 0: none
};

/// Errors: out_of_range (no patterns or channels, a pattern's value outside 0 .. 1 or not finite, an infinite code, a
/// noise or unit that is none), mismatch (sizes that do not agree with each other or the eye; times that do not
/// ascend; no pattern, or all of them, held out). The place is the field.
[[nodiscard]] hal::Result<void> validate(const Captures& captures, const CodeNoise& noise, const hal::EyeGeometry& eye,
                                         const hal::ObjectPlane& plane);

}  // namespace compueye::calib
