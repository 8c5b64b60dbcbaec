#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "drivers/device/called_device.hpp"
#include "drivers/device/frame_ring.hpp"
#include "drivers/device/hang_limits.hpp"
#include "drivers/device/own_thread.hpp"
#include "drivers/device/shared_time.hpp"
#include "hal/sample_source.hpp"

namespace compueye::device {

/// Another source, whose driver can hold nobody up: every call of it, from open to close, is made on a thread of its
/// own, and waited for as long as hang_limits say. Frames are those of the other source, bit for bit and in its books.
///
/// read() answers at its deadline and latest_answer_ns after it at most. A read that is not back by then goes on, and
/// what it brings is the answer of a later read(). With `frames_ahead` the device's thread also goes on once it has a
/// frame, so that the device is emptied in time however late its reader is: so many frames wait in memory that is made
/// before the first one, and it does not go on beyond a deadline that a reader gave. While it is longer overdue than
/// its limit the source is recovering(); after hang_given_up_after_ns read() says `disconnected` and which call hangs,
/// and stop() and start() try anew. A device that does not come back from stop() or close is left behind with its
/// thread, and everything it uses stays alive with it; should it come back all the same, it is stopped and closed
/// there.
///
/// The books: a frame that was read and that nobody asked for before stop() is dropped as stopped. Of a device that was
/// left behind they are what they were at the last frame.
///
/// After start() read() neither allocates nor throws while frames come.
class HangProofSource : public hal::SampleSource {
 public:
  using Source = CalledDevice::Source;
  /// Makes the other source, on the thread that calls it from then on; `clock` outlives the source.
  using Open = std::function<hal::Result<Source>(hal::Clock& clock)>;
  static constexpr std::size_t usual_ahead = 4;
  /// Something that only the device's thread may do with its source.
  using Act = std::function<hal::Result<void>(hal::SampleSource& source)>;

  /// `device` names it in errors until its serial is known. Errors: those of `open`; timeout (it hangs), no_space (no
  /// thread).
  [[nodiscard]] static hal::Result<std::unique_ptr<HangProofSource>> create(std::string device, Open open,
                                                                            SharedTime time = SharedTime::monotonic(),
                                                                            std::size_t frames_ahead = usual_ahead);
  HangProofSource(const HangProofSource&) = delete;
  HangProofSource& operator=(const HangProofSource&) = delete;
  ~HangProofSource() override;

  /// Stops it and gives the device back. Nothing but describe(), account() and counters() makes sense then. Error
  /// timeout: it hangs, and was left behind.
  [[nodiscard]] hal::Result<void> close();

  /// The call from which the device has not come back, once somebody went on without it. For the thread that reads.
  [[nodiscard]] const std::optional<hal::Error>& hang() const noexcept { return hang_; }

 protected:
  HangProofSource(std::string device, SharedTime time, std::size_t frames_ahead);
  [[nodiscard]] hal::Result<void> open(Open open);
  /// Between two reads. For the thread that reads. Errors: those of `act`; timeout (it hangs).
  [[nodiscard]] hal::Result<void> act(Act act);

 private:
  [[nodiscard]] const hal::SourceDescription& do_describe() const noexcept override { return description_; }
  hal::Result<void> do_start() override;
  hal::Result<hal::SampleBlock> do_read(std::int64_t deadline_ns) override;
  void do_stop() noexcept override;
  [[nodiscard]] hal::FrameAccount do_account() const noexcept override { return books_.account; }
  [[nodiscard]] bool do_recovering() const noexcept override;
  [[nodiscard]] bool do_withheld() const noexcept override { return books_.withheld; }
  [[nodiscard]] std::uint64_t do_outages() const noexcept override { return books_.outages; }
  [[nodiscard]] std::uint64_t do_faults() const noexcept override;
  [[nodiscard]] std::vector<hal::Counter> do_counters() const override;

  [[nodiscard]] std::int64_t now_ns() const noexcept { return time_.clock->now_ns(); }
  [[nodiscard]] bool made(DeviceCall call, std::int64_t until_ns) noexcept;
  void see(const SourceBooks& books) noexcept;
  [[nodiscard]] std::optional<hal::Error> end_of_reading(bool asked);
  [[nodiscard]] OwnThread::Pending pending() const noexcept;
  [[nodiscard]] hal::Result<hal::SampleBlock> late();
  [[nodiscard]] hal::Error hangs();

  const SharedTime time_;
  std::shared_ptr<CalledDevice> device_;  // null once it is closed
  std::unique_ptr<OwnThread> thread_;
  hal::SampleSource* source_ = nullptr;  // the device's: for what any thread may ask
  hal::SourceDescription description_;

  SourceBooks books_;  // as of the last frame or call that was looked at
  std::vector<hal::Counter> counters_;

  const std::size_t frames_ahead_;
  std::function<bool()> has_frame_;  // whether the ring has one
  std::uint64_t delivered_ = 0;
  bool reading_ = false;  // reads were asked for, and nobody has had their end
  bool given_up_ = false;
  std::thread::id reader_;
  std::atomic<bool> hanging_{false};
  std::atomic<std::uint64_t> hangs_{0};
  std::optional<hal::Error> hang_;
};

}  // namespace compueye::device
