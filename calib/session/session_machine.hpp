#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "calib/session/capture_builder.hpp"
#include "calib/session/capture_schedule.hpp"
#include "calib/session/frame_time.hpp"
#include "calib/session/session_plan.hpp"
#include "calib/session/settle_watch.hpp"
#include "hal/result.hpp"
#include "hal/sample_block.hpp"

namespace compueye::calib {

/// What the session needs next of whoever drives it.
enum class Need {
  light,   ///< show picture_of(wanted()), then lit()
  frame,   ///< read a frame, then saw()
  commit,  ///< store capture() where no power loss takes it away, then committed()
  nothing  ///< the schedule is at its end
};

/// The eye in front of the light, as it describes itself.
struct SessionEye {
  int channels = 0;
  int bits = 0;
  std::uint32_t configuration = 0;  ///< hal::SampleBlock::config_id of its frames
};

/// A session that was cut off.
struct Resumed {
  std::int64_t captures = 0;         ///< stored, none of stage `resumed`
  std::optional<Capture> reference;  ///< the last one stored under white
};

struct SessionProgress {
  std::string_view stage;
  std::int64_t taken = 0, of = 0;  ///< captures, those of the session that was cut off included
  std::array<std::uint64_t, rejections> rejected{};
  double signal_lsb = 0.0;             ///< of the median channel under white, over the dark; 0: not seen yet
  double settle_ms = 0.0;              ///< waited after a change, three times what was measured; 0: not yet
  std::optional<double> seconds_left;  ///< by what captures took so far
};

/// A calibration session that takes time as an argument: warm-up, how long light needs to settle, whether there is
/// enough and not too much of it, then the schedule. It owns no clock, eye or light; frames that were exposed before
/// the light was settled are passed over.
class SessionMachine {
 public:
  /// Errors: those of validate(SessionPlan); out_of_range (more frames than a capture's sums hold; no channels).
  [[nodiscard]] static hal::Result<SessionMachine> create(const SessionPlan& plan, const SessionEye& eye, int rows,
                                                          int cols, const Resumed& resumed, std::int64_t now_ns);
  /// The same for a schedule of one's own.
  [[nodiscard]] static hal::Result<SessionMachine> create(const SessionPlan& plan, const SessionEye& eye,
                                                          std::vector<Wanted> schedule, const Resumed& resumed,
                                                          std::int64_t now_ns);

  [[nodiscard]] Need need() const noexcept { return need_; }
  [[nodiscard]] const Wanted& wanted() const noexcept { return wanted_; }
  [[nodiscard]] const Capture& capture() const noexcept { return builder_.capture(); }
  [[nodiscard]] SessionProgress progress(std::int64_t now_ns) const;

  /// The light was changed at `now_ns`; whoever shows it says that it is stable from `stable_ns` on.
  void lit(std::int64_t now_ns, std::int64_t stable_ns) noexcept;
  /// Errors, at which the session ends and may be resumed: out_of_range (too much light, too little, or none that
  /// settles: the sentence says what to change), mismatch (after a resume the reference has changed; the device's time
  /// falls behind too fast); and where a
  /// capture was taken again too often, io, or one of these.
  [[nodiscard]] hal::Result<void> saw(const hal::SampleBlock& block, std::int64_t now_ns);
  void committed(std::int64_t now_ns) noexcept;
  /// The source lost its device or its stream, and has it back or is getting it back: the light is shown anew, since a
  /// lamp of the device went out meanwhile, and what was being taken begins again. Errors: as of saw().
  [[nodiscard]] hal::Result<void> recovered(std::int64_t now_ns);

 private:
  enum class Phase { warm_up, falling, rising, level_dark, level_white, resume, captures };

  SessionMachine(const SessionPlan& plan, const SessionEye& eye, std::vector<Wanted> schedule, const Resumed& resumed,
                 std::int64_t now_ns);
  void begin(Phase phase);
  void want(const Wanted& wanted);
  void want_capture(std::int64_t now_ns);
  [[nodiscard]] hal::Result<void> saw_settling(std::int64_t begun_ns, const hal::SampleBlock& block);
  [[nodiscard]] hal::Result<void> saw_capture(const hal::SampleBlock& block, std::int64_t now_ns);
  [[nodiscard]] hal::Result<void> pass_over(std::int64_t waited_ns);
  [[nodiscard]] hal::Result<void> taken_too_often() const;
  [[nodiscard]] hal::Result<void> check_level() const;
  [[nodiscard]] hal::Result<void> check_reference() const;
  [[nodiscard]] std::vector<double> signal() const;

  SessionPlan plan_;
  SessionEye eye_;
  std::vector<Wanted> schedule_;
  Resumed resumed_;
  Phase phase_ = Phase::warm_up;
  Need need_ = Need::light;
  Wanted wanted_;
  CaptureBuilder builder_;
  FrameTime frame_time_;
  std::optional<SettleWatch> watch_;
  Capture dark_, white_;  // of the check of the level
  std::int64_t warm_ns_ = 0, captures_began_ns_ = 0;
  std::int64_t lit_ns_ = 0, stable_ns_ = 0, settle_ns_ = 0;
  std::int64_t position_ = 0;
  int passed_over_ = 0;  // frames since lit()
  double signal_lsb_ = 0.0;
};

}  // namespace compueye::calib
