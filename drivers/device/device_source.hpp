#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/device/back_off.hpp"
#include "drivers/device/device_machine.hpp"
#include "drivers/device/device_requests.hpp"
#include "drivers/device/device_settings.hpp"
#include "drivers/device/eye_controls.hpp"
#include "drivers/device/failure_counters.hpp"
#include "drivers/device/stream_extent.hpp"
#include "drivers/device/stream_reader.hpp"
#include "drivers/protocol/descriptor.hpp"
#include "drivers/protocol/descriptor_pages.hpp"
#include "hal/byte_transport.hpp"
#include "hal/clock.hpp"
#include "hal/sample_source.hpp"

namespace compueye::device {

/// An eye on a cable as a source of samples: DeviceMachine carried out over a transport.
///
/// read() recovers by itself from everything that docs/protocol.md says can go wrong and docs/faults.md lists;
/// meanwhile it times out. It returns `disconnected` when that was given up (DeviceSettings::recovery_limit_ns), with a
/// sentence that says why; stop() and start() try anew. A request that read() needs is cut off at its deadline and
/// repeated by the next one, so recovery wants deadlines that the device can answer in: it has 100 ms, and takes 1 to
/// 10 as a rule.
///
/// The transport's open() has to look for the eye anew: after a re-plug it has another address. Another eye in its
/// place is left alone.
///
/// SampleBlock::config_id stays what it was at the start of a run: each stream of it has an id of its own, so that
/// leftovers are told apart, but the configuration is the same, and the device's echo has shown it.
///
/// Accounting: every exposure from START on, in this run, is delivered or dropped for one reason. Frames that were on
/// their way when a stream ended are dropped as transport_gap (as corrupt after babble, stopped after stop()), as many
/// as the device says it made; StreamExtent says how many those are when it cannot be asked. While it is unplugged,
/// starts, or streams unasked, it makes no frames of this run.
///
/// After start() read() neither allocates nor throws while frames come. Recovery allocates: errors with text, the
/// descriptor of a device that was plugged in again (1 MiB at most).
class DeviceSource final : public hal::SampleSource, public EyeControls {
 public:
  /// Opens the eye and identifies it, for DeviceSettings::start_limit_ns at most. `clock` must outlive the source.
  /// Errors: usage (no transport), out_of_range (a setting), not_found (no eye, or another serial), unsupported
  /// (another protocol version; an eye that HID cannot carry), timeout, io, bad_format (it does not answer as an eye
  /// does). They name the serial or bus.
  [[nodiscard]] static hal::Result<std::unique_ptr<DeviceSource>> create(DeviceSettings settings,
                                                                         std::unique_ptr<hal::ByteTransport> transport,
                                                                         hal::Clock& clock);
  DeviceSource(const DeviceSource&) = delete;
  DeviceSource& operator=(const DeviceSource&) = delete;
  ~DeviceSource() override;

  [[nodiscard]] hal::Result<void> set_exposure(std::int64_t exposure_ns) override;
  [[nodiscard]] hal::Result<void> set_illumination(const protocol::Illumination& wanted) override;
  [[nodiscard]] std::int64_t exposure_ns() const noexcept override { return configuration_.exposure_ns; }

  /// counters(), by what they are.
  [[nodiscard]] FailureCounters failures() const noexcept;
  [[nodiscard]] MachineState state() const noexcept { return machine_.state(); }
  [[nodiscard]] const protocol::DeviceDescriptor& descriptor() const noexcept override { return *descriptor_; }
  [[nodiscard]] const protocol::Configuration& configuration() const noexcept { return configuration_; }
  [[nodiscard]] const DeviceSettings& settings() const noexcept { return settings_; }

 private:
  DeviceSource(DeviceSettings settings, std::unique_ptr<hal::ByteTransport> transport, hal::Clock& clock);

  // Frames: device_source.cpp
  [[nodiscard]] const hal::SourceDescription& do_describe() const noexcept override { return description_; }
  hal::Result<void> do_start() override;
  hal::Result<hal::SampleBlock> do_read(std::int64_t deadline_ns) override;
  void do_stop() noexcept override;
  [[nodiscard]] hal::FrameAccount do_account() const noexcept override;
  [[nodiscard]] bool do_recovering() const noexcept override { return recovering_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t do_outages() const noexcept override { return failures_[Failure::restart]; }
  [[nodiscard]] std::uint64_t do_faults() const noexcept override { return faults_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::vector<hal::Counter> do_counters() const override { return failures().counters(); }
  [[nodiscard]] hal::Result<hal::SampleBlock> read_or_recover(std::int64_t deadline_ns);
  void count_faults() noexcept;
  [[nodiscard]] std::optional<hal::SampleBlock> read_stream(std::int64_t deadline_ns);
  void saw_frame(hal::SampleBlock& block) noexcept;
  void fail_quiet();
  void hand_over(std::int64_t deadline_ns);
  [[nodiscard]] bool ask_time(std::int64_t deadline_ns);
  [[nodiscard]] bool quiet_for_too_long() const noexcept;
  [[nodiscard]] bool end_stream(hal::DropReason reason, std::int64_t until_ns);
  void close_stream(const StreamExtent::Frames& frames, hal::DropReason reason) noexcept;

  // Set-up and recovery: device_recovery.cpp
  hal::Result<void> get_to(MachineState state, std::int64_t limit_ns);
  void carry_out(Order order, std::int64_t until_ns);
  [[nodiscard]] hal::Result<void> attempt(Order order, std::int64_t until_ns);
  void pause(std::int64_t until_ns);
  void saw_gone(std::int64_t now_ns) noexcept;
  template <class T>
  void saw_there(const hal::Result<T>& looked) noexcept {
    if (looked || looked.error().code != hal::ErrorCode::disconnected) there_ns_ = clock_.now_ns();
  }
  /// For the device, since look_began_ns_.
  [[nodiscard]] bool waited(std::int64_t now_ns) const noexcept {
    return now_ns - look_began_ns_ > configuration_.period_ns() / 16;
  }
  [[nodiscard]] hal::Result<void> open();
  void close_transport() noexcept;
  [[nodiscard]] hal::Result<void> ping(std::int64_t until_ns);
  [[nodiscard]] hal::Result<void> look_at_status(std::int64_t until_ns);
  [[nodiscard]] bool started_anew(const protocol::Status& status) noexcept;
  [[nodiscard]] hal::Result<void> compare_echo(std::int64_t until_ns);
  [[nodiscard]] hal::Result<void> fetch_descriptor(std::int64_t until_ns);
  [[nodiscard]] hal::Result<void> judge(protocol::DeviceDescriptor found);
  [[nodiscard]] hal::Error too_slow(std::int64_t limit_ns) const;
  [[nodiscard]] tl::unexpected<hal::Error> other_eye(const std::string& found);
  void next_config_id() noexcept;
  void begin_stream() noexcept;
  void fail(Failure why, hal::Error error);
  [[nodiscard]] hal::Error given_up(std::int64_t deadline_ns);

  DeviceSettings settings_;
  std::unique_ptr<hal::ByteTransport> transport_;
  hal::Clock& clock_;
  bool transport_open_ = false;
  DeviceRequests requests_;
  DeviceMachine machine_;
  std::atomic<bool> recovering_{false};
  std::atomic<std::uint64_t> faults_{0};
  FailureCounters failures_;
  hal::Error last_error_;
  std::int64_t gave_up_after_ns_ = 0;
  std::int64_t unanswered_ns_ = 0;  // what requests waited in vain that were cut short
  std::optional<Failure> blame_;    // of the order that failed, where its error does not say

  std::optional<protocol::DeviceDescriptor> descriptor_;
  hal::SourceDescription description_;
  std::string serial_;  // that we are bound to; empty until one was identified
  std::optional<protocol::DescriptorPages> pages_;
  std::int64_t pages_ns_ = 0;  // when the first was asked for
  protocol::Configuration configuration_;
  protocol::Status status_;  // the last one that IDENTIFY got
  bool has_status_ = false;
  bool clock_anew_ = false;  // the device's clock started anew since the last frame

  std::uint32_t run_config_id_ = 0;  // what the frames of a run say, whatever stream they came in
  std::unique_ptr<StreamReader> reader_;
  std::vector<std::byte> chunk_;
  StreamExtent extent_;
  std::uint64_t stream_base_ = 0;      // the run's number of the stream's frame 0
  std::uint64_t stream_overruns_ = 0;  // counted before this stream
  std::uint64_t estimated_ = 0;        // of the dropped
  hal::DropReason lost_as_ = hal::DropReason::transport_gap;
  std::int64_t silence_ns_ = 0;
  std::size_t babble_bytes_ = 0;                // that hold a frame if anything does
  int late_reads_ = 1;                          // after the deadline, to put one frame together
  std::optional<std::int64_t> quiet_since_ns_;  // since when frames are waited for
  std::size_t bytes_since_frame_ = 0;
  bool waited_ = false;  // for the last chunk
  std::int64_t look_began_ns_ = 0, there_ns_ = 0;
  std::size_t held_bytes_ = 0;  // of the chunk, that the reader has yet to get
  int times_held_ = 0;
  int farewells_ = 0;             // tries to ask a device that was given up
  std::int64_t ask_time_ns_ = 0;  // not before
  BackOff ask_time_pause_;
};

}  // namespace compueye::device
