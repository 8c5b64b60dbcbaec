#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "calib/session/capture.hpp"
#include "calib/session/capture_schedule.hpp"
#include "calib/session/frame_time.hpp"
#include "calib/session/session_machine.hpp"
#include "calib/session/session_plan.hpp"
#include "firmware/calibration/ommatidium_order.hpp"
#include "hal/clock.hpp"
#include "hal/illuminator.hpp"
#include "hal/sample_source.hpp"

namespace compueye::firmware {

/// When a running eye is looked at, and what by.
struct CheckSettings {
  std::int64_t every_ns = 0;            ///< of the frames' own time between two checks, > 0
  calib::SessionPlan plan;              ///< by which the light is found good enough; its warm-up is each check's
  std::vector<calib::Wanted> schedule;  ///< what is taken
  /// Made for each check, used by the thread that reads, and gone after it.
  std::function<hal::Result<std::unique_ptr<hal::Illuminator>>()> light;
};

/// What a check saw, or why it could not look.
struct CheckLook {
  std::int64_t device_ns = 0;  ///< of the frame that it began after
  hal::Result<std::vector<calib::Capture>> seen;
};

/// Another source, out of which the frames of checks are taken: from time to time a light shows pictures before the
/// eye, and what frames see of them is for next_look(). Frames are the reader's again once their exposure began after
/// the light was settled out; those in between are account().checked, and their numbers are jumped over.
///
/// Time between checks is that of the frames' time stamps. Between checks read() neither allocates nor waits beside the
/// source; a check does, as much as its light. A check that cannot look ends with its error and no frame with it; an
/// outage is looked through by a session's rules. Only a lamp that cannot be put out for five seconds ends the stream,
/// since no frame is of the scene then: read() says why.
class CheckedSource final : public hal::SampleSource {
 public:
  /// `source` and `clock`, which is the source's, must outlive it.
  CheckedSource(CheckSettings settings, hal::SampleSource& source, hal::Clock& clock);
  CheckedSource(const CheckedSource&) = delete;
  CheckedSource& operator=(const CheckedSource&) = delete;
  ~CheckedSource() override { stop(); }

  // From any thread:
  /// Frames of checks since start().
  [[nodiscard]] const std::atomic<std::uint64_t>& checked() const noexcept { return checked_; }
  /// From a check's beginning to the next frame of the scene.
  [[nodiscard]] const std::atomic<bool>& checking() const noexcept { return checking_; }
  /// The next check comes with the next frame of the scene.
  void look_again() noexcept { again_ = true; }
  /// The oldest one that was not asked for.
  [[nodiscard]] std::optional<CheckLook> next_look();

 private:
  [[nodiscard]] const hal::SourceDescription& do_describe() const noexcept override { return source_.describe(); }
  hal::Result<void> do_start() override;
  hal::Result<hal::SampleBlock> do_read(std::int64_t deadline_ns) override;
  void do_stop() noexcept override;
  [[nodiscard]] hal::FrameAccount do_account() const noexcept override;
  [[nodiscard]] bool do_recovering() const noexcept override { return source_.recovering(); }
  [[nodiscard]] bool do_withheld() const noexcept override { return withheld_; }
  [[nodiscard]] std::uint64_t do_outages() const noexcept override { return source_.outages(); }
  [[nodiscard]] std::uint64_t do_faults() const noexcept override { return source_.faults(); }
  [[nodiscard]] std::vector<hal::Counter> do_counters() const override { return source_.counters(); }

  void book(bool of_check) noexcept;
  [[nodiscard]] bool is_of_scene(const hal::SampleBlock& block, std::int64_t begun_ns) noexcept;
  void pass_time(const hal::SampleBlock& block) noexcept;
  void begin();
  [[nodiscard]] hal::Result<void> look(const hal::SampleBlock& block);
  [[nodiscard]] hal::Result<void> serve();
  void end(hal::Result<std::vector<calib::Capture>> seen);
  [[nodiscard]] hal::Result<void> put_out(std::int64_t now_ns);

  CheckSettings settings_;
  hal::SampleSource& source_;
  hal::Clock& clock_;
  OmmatidiumOrder order_;
  std::int64_t period_ns_;

  calib::FrameTime frame_time_;
  std::int64_t last_ns_ = 0, passed_ns_ = 0;  // device time of the last frame, and what passed since the last check
  std::uint32_t config_id_ = 0;
  std::uint64_t outages_ = 0, delivered_ = 0;
  std::atomic<std::uint64_t> checked_ = 0;
  hal::FrameAccount booked_, of_checks_;  // the source's when its last frame came, and what of it was lost in checks
  bool was_of_check_ = false;             // that frame
  std::atomic<bool> checking_ = false;
  std::atomic<bool> again_ = false;
  bool due_ = false, withheld_ = false;

  std::optional<calib::SessionMachine> machine_;  // while it looks
  std::vector<calib::Capture> taken_;
  std::unique_ptr<hal::Illuminator> light_;  // until it is put out
  std::int64_t settle_ns_ = 0, scene_from_ns_ = 0, tried_ns_ = 0;
  int tries_ = 0;

  std::mutex mutex_;
  std::deque<CheckLook> looks_;
};

}  // namespace compueye::firmware
