#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "hal/accounting.hpp"
#include "hal/result.hpp"
#include "hal/sample_block.hpp"
#include "hal/sample_source.hpp"

namespace compueye::firmware {

/// What a calibration measured of the sensor, by ommatidium. A straightened code is the one that a converter without
/// bends would have given.
struct MeasuredSensor {
  std::vector<std::uint8_t> masked;  ///< M, not 0: never used, and counts as blind; empty: none
  std::vector<float> dark;           ///< M straightened codes, finite; empty: CorrectionSettings::dark holds
  std::vector<float> codes;          ///< K >= 2, finite, ascending; empty: the converter is straight
  std::vector<float> straightened;   ///< K an ommatidium, finite: of each of `codes`
};

/// What is known about the sensor of one eye. Channel = position in a SampleBlock, ommatidium = row of A.
struct CorrectionSettings {
  std::vector<float> dark;                  ///< M codes by channel, finite; empty: 0
  std::vector<float> gain;                  ///< M factors by channel, > 0; empty: 1
  double lsb = 1.0;                         ///< > 0: what one code is worth, in fully seen white pixels
  std::vector<std::int32_t> dead_channels;  ///< channels that are never used
  std::vector<std::uint8_t> sees;           ///< M flags by ommatidium, 0 = blind row of A; empty: all see
  MeasuredSensor measured;                  ///< nothing in it: not measured
  double saturation_share = 0.98;           ///< > 0: codes from this share of full scale on are not used; > 1: off
  double max_missing_share = 0.05;          ///< 0..1 of the seeing channels that a usable frame may lack
  std::optional<std::uint32_t> expected_config_id;  ///< empty: that of the first frame of the run
};

/// What the correct stage found in one frame.
struct CorrectionReport {
  bool usable = false;
  hal::DropReason reason = hal::DropReason::corrupt;  ///< meaningful when not usable
  bool config_mismatch = false;                       ///< corrupt because taken with another configuration
  int masked = 0;                                     ///< seeing channels with weight 0, the dead ones included
  int saturated = 0;                                  ///< seeing channels at or above the saturation threshold
};

/// codes -> y and weights: y[ommatidium] = (code - dark) * gain * lsb with weight 1, or 0 with weight 0 where the
/// channel is dead, masked, invalid, saturated or out of the code range. Where a linearity was measured the code is
/// straightened first, on straight lines between its points; beyond them the last one goes on.
///
/// A frame is `corrupt` when its size or bit depth is not what the source described, or when its config_id differs:
/// dark, gain and lsb belong to one configuration (integration time, range), so samples taken with another would make
/// a plausible but wrong picture. The reference stays the expected or first configuration of the run; frames are
/// usable again when the device returns to it.
class Correction {
 public:
  /// Errors: mismatch (sizes, channel map with a repeat), out_of_range (a value named with its place), and usage
  /// when the dead channels alone exceed max_missing_share, because then no frame could ever pass.
  [[nodiscard]] static hal::Result<Correction> create(const CorrectionSettings& settings,
                                                      const hal::SourceDescription& source);

  /// `y` and `weights` have M entries and are wholly written if the frame is usable. Does not allocate.
  CorrectionReport apply(const hal::SampleBlock& block, std::span<float> y, std::span<float> weights) noexcept;

  /// A new run: forgets the configuration of the last one.
  void restart() noexcept { config_ = expected_config_; }

  [[nodiscard]] int channels() const noexcept { return static_cast<int>(channels_.size()); }
  [[nodiscard]] int seeing_channels() const noexcept { return seeing_; }
  /// The configuration frames must have; empty before the first frame when none was expected.
  [[nodiscard]] std::optional<std::uint32_t> config_id() const noexcept { return config_; }
  /// First code that counts as saturated.
  [[nodiscard]] std::int32_t saturation_code() const noexcept { return saturation_code_; }

 private:
  struct Channel {
    std::int32_t ommatidium = 0;
    float dark = 0.0F;
    float scale = 1.0F;
    bool alive = true;
    bool sees = true;
  };
  /// A straight line between two measured points of a channel.
  struct Piece {
    float first = 0.0F;
    float slope = 0.0F;
  };
  [[nodiscard]] bool matches_configuration(const hal::SampleBlock& block) noexcept;
  void take_measured(const MeasuredSensor& measured);
  [[nodiscard]] float straightened(std::size_t channel, float code) const noexcept;

  std::vector<Channel> channels_;
  std::vector<float> knots_;   // where pieces begin; empty: the converter is straight
  std::vector<Piece> pieces_;  // knots_.size() a channel
  int bits_ = 0;
  int seeing_ = 0;
  int max_masked_ = 0;
  std::int32_t saturation_code_ = 0;
  std::optional<std::uint32_t> expected_config_;
  std::optional<std::uint32_t> config_;
};

}  // namespace compueye::firmware
