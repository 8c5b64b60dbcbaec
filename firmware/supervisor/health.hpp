#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "firmware/pipeline/stage_beat.hpp"
#include "firmware/supervisor/health_limits.hpp"

namespace compueye::firmware {

/// What the newest picture is worth to somebody who looks at it.
enum class PictureState : std::uint8_t {
  starting,  ///< there is none yet
  live,      ///< new and sharp as far as anybody knows
  late,      ///< new, but many of the last ones were older than the deadline
  degraded,  ///< new, but made without channels that should be there, or the response does not explain the samples
  held,      ///< the last one, which gets old: no newer one came
  blank,     ///< none: the last one is too old to act upon
};

/// Why the picture is not live, the gravest first.
enum class Trouble : std::uint8_t {
  none,
  stuck,       ///< a stage does not come back from a piece of work: restart
  fruitless,   ///< frames come, and a stage throws every one of them away for a fault: restart
  recovering,  ///< the source lost its eye and is getting it back
  checking,    ///< frames are kept for a check of the eye
  slow,        ///< a stage works longer than usual, and not long enough to be stuck
  silent,      ///< no frame comes, and the source does not know why
  unusable,    ///< frames come, and too few channels of them see
  deadline,    ///< pictures are too old when they come
  channels,    ///< channels are left out
  misfit,      ///< the response does not explain the samples
};

/// A row a state: what it is called, what is done to the picture, and how grave it is to a reader of logs.
struct PictureStateRow {
  PictureState state;
  std::string_view name;
  std::string_view picture;  ///< what becomes of the one on the screen
  int priority;              ///< of syslog(3): 6 info, 5 notice, 4 warning, 3 error
};
inline constexpr std::array<PictureStateRow, 6> picture_states{{
    {PictureState::starting, "starting", "none yet", 6},
    {PictureState::live, "live", "each new one is shown", 6},
    {PictureState::late, "late", "each new one is shown, and its age with it", 4},
    {PictureState::degraded, "degraded", "each new one is shown, and what is wrong with it", 4},
    {PictureState::held, "held", "the last one stays, and is said to be held", 5},
    {PictureState::blank, "blank", "taken away: nobody may act upon it", 4},
}};
[[nodiscard]] std::string_view name(PictureState state) noexcept;

/// A row a trouble: when it is said to be there, and whether a restart is the cure.
struct TroubleRow {
  Trouble trouble;
  std::string_view name;
  std::string_view meaning;
  bool restart;
};
inline constexpr std::array<TroubleRow, 11> troubles{{
    {Trouble::none, "none", "", false},
    {Trouble::stuck, "stuck", "a stage does not come back from one piece of work", true},
    {Trouble::fruitless, "fruitless", "a stage throws every frame away as faulty", true},
    {Trouble::recovering, "recovering", "the eye is lost, and the driver is getting it back", false},
    {Trouble::checking, "checking", "frames are kept for a check of the eye", false},
    {Trouble::slow, "slow", "a stage is still at one piece of work", false},
    {Trouble::silent, "silent", "no frame comes from the eye", false},
    {Trouble::unusable, "unusable", "frames come, and too few of their channels see", false},
    {Trouble::deadline, "deadline", "pictures are older than the deadline when they come", false},
    {Trouble::channels, "channels", "channels are left out", false},
    {Trouble::misfit, "misfit", "the response does not explain the samples", false},
}};
[[nodiscard]] std::string_view name(Trouble trouble) noexcept;

/// All that is known of a run at one moment. Times on the pipeline's clock.
struct RunCounters {
  std::int64_t begun_ns = 0;
  std::array<StageProgress, stage_count> stages;
  std::uint64_t published = 0;
  std::int64_t published_at_ns = 0;  ///< the last one; meaningful when `published` > 0
  std::int64_t interval_ns = 0;      ///< between the last two, 0: there were none
  std::uint32_t late_bits = 0;       ///< of the last 32 pictures, the last one lowest
  bool recovering = false;           ///< SampleSource::recovering()
  bool checking = false;
  std::uint64_t left_out = 0;  ///< channels
  double misfit = 0.0;         ///< times what noise explains the residual is, 0: it fits
};

/// What counters come to.
struct Health {
  PictureState picture = PictureState::starting;
  Trouble trouble = Trouble::none;
  std::optional<Stage> stage;   ///< whose trouble it is
  std::int64_t picture_ns = 0;  ///< since the last picture, or since the run began
  std::int64_t trouble_ns = 0;  ///< how long the stage has been stuck, slow or fruitless
  std::uint64_t left_out = 0;   ///< channels
  double misfit = 0.0;

  /// Whether the run gets on, or waits for something that will come without a restart.
  [[nodiscard]] bool alive() const noexcept { return !troubles[static_cast<std::size_t>(trouble)].restart; }
  /// "picture held for 0.4 s: the eye is lost, and the driver is getting it back".
  [[nodiscard]] std::string sentence() const;
  /// Whether a reader would be told the same of both but for numbers.
  [[nodiscard]] bool like(const Health& other) const noexcept {
    return picture == other.picture && trouble == other.trouble && stage == other.stage;
  }
};

/// The tables of docs/service.md.
[[nodiscard]] std::string picture_reference();
[[nodiscard]] std::string trouble_reference();

/// A pure function of the time and the counters: no clock, no memory of what it said before.
[[nodiscard]] Health assess(const HealthLimits& limits, std::int64_t now_ns, const RunCounters& counters) noexcept;

}  // namespace compueye::firmware
