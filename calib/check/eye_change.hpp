#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "calib/check/turn_slopes.hpp"
#include "hal/result.hpp"

namespace compueye::calib {

/// The same K pictures before an eye of M channels, twice: in the session, and now.
struct CheckSamples {
  int channels = 0;
  std::vector<double> then, then_variance;                 ///< K x M, in fully seen white pixels; NaN: none
  std::vector<double> now, now_variance;                   ///< likewise
  std::vector<std::array<double, turn_axes>> by_turn;      ///< K x M: what a turn changes, per radian
  std::vector<std::uint8_t> judged;                        ///< M; 0: masked, tells nothing
  std::vector<double> dark_then, dark_now, dark_variance;  ///< M: without light, likewise; the variance of the two
  double dark_spread = 0.0;   ///< how far all of them went together in the session by themselves
  double light_spread = 0.0;  ///< standard deviation of the light itself, relative: of one picture and from day to day
};

/// A quantity with its standard deviation, and how probable so large a one is where nothing has changed.
struct Tested {
  double value = 0.0, sigma = 0.0;
  double chance = 1.0;
};

struct ChangedChannel {
  int channel = 0;
  Tested change;  ///< of its light, relative to what it gave and to all others
};

struct EyeChange {
  Tested gain;                               ///< relative, common to all: of the light or of the eye
  std::array<double, turn_axes> turn_rad{};  ///< of the eye, or of the display the other way
  std::array<double, turn_axes> turn_sigma{};
  double turn_chance = 1.0;                   ///< of all three together
  std::vector<ChangedChannel> channels;       ///< those that changed, ascending
  Tested dark;                                ///< level without light of all together, relative to the median white
  std::vector<ChangedChannel> dark_channels;  ///< whose level went beside all others', likewise
  double rest_chi2 = 0.0;                     ///< a sample, of what all this leaves of the channels that did not
  double rest_share = 0.0;                    ///< of that, what noise does not explain, rms, relative to the light
  double rest_chance = 1.0;
  double noise_ratio = 1.0;  ///< how much the middle one of what is left is more than noise was, at least 1

  bool noisier = false;  ///< and it was seen in all, not in some: no one question has the answer
  bool gain_changed = false, turned = false, rest_changed = false, dark_changed = false;
  bool dark_judged = true;  ///< false: there was light that was not the lamp's, which may be all that differs
  [[nodiscard]] bool changed() const noexcept {
    return noisier || gain_changed || turned || rest_changed || dark_changed || !channels.empty() ||
           !dark_channels.empty();
  }
};

/// What is smaller changes no picture, however certain it is: with 16 bits noise is a thousandth of these.
struct LeastChange {
  static constexpr double gain = 5e-4;         ///< relative
  static constexpr double turn_rad = 1.75e-4;  ///< 0.01 degrees
  static constexpr double channel = 5e-3;      ///< of one ommatidium, relative
  static constexpr double dark = 1e-3;         ///< of all dark levels, relative to the white of the median channel
  static constexpr double one_dark = 5e-3;     ///< of one
  static constexpr double rest = 2e-3;         ///< of what is left, relative to the light, rms
  static constexpr double noise_ratio = 2.0;
};

/// False alarms a check: at most this share, each of its six questions taking a sixth of it.
inline constexpr double false_alarms = 1e-3;

/// Whether an eye sees as it did: its dark levels, its gain, its pose, single ommatidia, or anything else, told apart
/// from noise. One weighted least squares fit of gain, turn and each picture's own light to all channels; a channel
/// that stands out of it is taken out, the worst first, and the fit repeated, so that neither hides the other. What the
/// light did by itself in the session counts as noise of the gain: a restless lamp hides a small change, and does not
/// raise an alarm. Where the middle one of what is left is more than the session's noise, that is the noise of now, and
/// every question is asked with it.
///
/// Errors: mismatch (sizes), out_of_range (a spread that is none), usage (fewer channels than four that give light).
[[nodiscard]] hal::Result<EyeChange> eye_change(const CheckSamples& samples);

}  // namespace compueye::calib
