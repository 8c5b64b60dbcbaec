#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>

#include "firmware/app/session.hpp"
#include "firmware/eye/board.hpp"
#include "firmware/pipeline/settings.hpp"
#include "firmware/pipeline/stage_beat.hpp"
#include "firmware/realtime/realtime.hpp"
#include "firmware/service/restart_count.hpp"
#include "firmware/sinks/live_status.hpp"
#include "firmware/supervisor/picture_clock.hpp"
#include "firmware/supervisor/supervisor.hpp"
#include "firmware/text/figures.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// What stands around a run: the service manager that started it, if any, the supervisor, and what the operating
/// system is asked for.
class RunSupervision {
 public:
  /// `session` must outlive it.
  explicit RunSupervision(Session& session);
  ~RunSupervision();

  /// A service that failed before waits, longer each time. Error interrupted when a stop came meanwhile.
  [[nodiscard]] hal::Result<void> wait_for_turn();
  /// Once the board is known, and before threads of a solver are made.
  void board_is(const Board& board);
  /// Into the pipeline's settings: heartbeats, and what each thread asks for.
  void join(PipelineSettings& settings);
  /// Told of every picture before `next`, which must outlive the run.
  [[nodiscard]] FrameObserver& observe(FrameObserver& next);

  /// Ten times a second while the run goes on, from one thread.
  void look(const LiveStatus& status);
  /// As of the last look.
  [[nodiscard]] PictureAge picture() const noexcept;
  /// The run is over. Errors: those of forgetting earlier failures.
  void end(bool failed);

  /// For the report; what the operating system granted and refused is in it and, refused, in notes.
  [[nodiscard]] Figures figures() const;
  [[nodiscard]] std::uint64_t interruptions() const noexcept { return supervisor_->interruptions(); }
  [[nodiscard]] std::vector<std::string> refusals() const {
    return realtime_ ? realtime_->notes() : std::vector<std::string>();
  }

 private:
  Session& session_;
  std::unique_ptr<ServiceManager> manager_;
  RestartCount restarts_;
  StageBeats beats_;
  std::optional<Realtime> realtime_;
  std::optional<PictureClock> pictures_;
  std::optional<StatusLine> line_;
  std::optional<Supervisor> supervisor_;
  HealthLimits limits_;
  std::int64_t begun_ns_ = 0, extended_ns_ = 0;
  bool went_well_ = false;
};

}  // namespace compueye::firmware
