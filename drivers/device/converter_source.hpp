#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/device/back_off.hpp"
#include "drivers/device/converter_failures.hpp"
#include "drivers/device/edge_pace.hpp"
#include "drivers/frontend/front_end.hpp"
#include "hal/clock.hpp"
#include "hal/sample_source.hpp"
#include "hal/signal_lines.hpp"
#include "hal/spi_bus.hpp"

namespace compueye::device {

/// The wires of an eye whose converters hang on the host itself.
struct ConverterWires {
  std::unique_ptr<hal::SpiBus> data;                ///< never null
  std::unique_ptr<hal::SpiBus> settings = nullptr;  ///< FrontEndRow::settings_bus
  std::unique_ptr<hal::OutputLines> select = nullptr;
  std::unique_ptr<hal::OutputLines> reset = nullptr;
  std::unique_ptr<hal::OutputLines> sync = nullptr;  ///< one line, high while a frame is read
  std::unique_ptr<hal::EdgeLine> ready = nullptr;    ///< FrontEndRow::data_ready
};

struct ConverterSettings {
  const frontend::FrontEndRow* chip = nullptr;  ///< never null
  frontend::FrontEndSettings front_end;
  std::string serial;                                    ///< that the board gives it: converters have none
  std::vector<std::int32_t> ommatidium_of_channel = {};  ///< M entries; none: channel c is ommatidium c

  /// How long there may be no frame before the chips are reset: more than a frame period; 0: five periods, but at least
  /// 50 ms.
  std::int64_t silence_ns = 0;
  /// How long read() tries to get frames again, in its own waiting time; 0: not at all.
  std::int64_t recovery_limit_ns = 30'000'000'000;
  BackOffSettings back_off = {};  ///< pauses between attempts
};

/// An eye of converters on SPI, read by the host: a hal::SampleSource over frontend::FrontEnd.
///
/// The host times the frames. Where chips say that data are ready, a frame is one of their conversions, EdgePace says
/// which, and its time is the edge's less a period; otherwise the host asks once a period of its own clock, and the
/// time is when it asked. A frame that was over before the host came to it is dropped as device_overrun, one whose edge
/// never came or whose transfer failed as transport_gap, one in which no chip is to be trusted as corrupt; one with
/// some chips of that kind is delivered without their channels.
///
/// read() recovers by itself: chips are reset and set anew after three frames without a good chip, after one that says
/// that it lost its settings, after a failed transfer and in silence; the second attempt opens the device files anew.
/// Meanwhile it times out, and no frames are made; an outage is over with the third frame after it. It returns
/// `disconnected` when that was given up. An attempt is not cut off at read()'s deadline: it takes what the chips'
/// resets take, 20 ms as a rule.
///
/// After start() read() neither allocates nor throws while frames come.
class ConverterSource final : public hal::SampleSource {
 public:
  /// Opens the wires and sets the chips up. `clock` must outlive the source, and is the one whose time edges have.
  /// Errors: usage (wires that the chip needs and that are not there), out_of_range (a setting), mismatch (another
  /// chip), those of the wires.
  [[nodiscard]] static hal::Result<std::unique_ptr<ConverterSource>> create(ConverterSettings settings,
                                                                            ConverterWires wires, hal::Clock& clock);
  ConverterSource(const ConverterSource&) = delete;
  ConverterSource& operator=(const ConverterSource&) = delete;
  ~ConverterSource() override;

  [[nodiscard]] const ConverterFailures& failures() const noexcept { return failures_; }

 private:
  /// A frame that is due: its number behind the last one was counted, and its time.
  struct Due {
    std::int64_t t_ns = 0;      ///< start of exposure
    std::int64_t until_ns = 0;  ///< when the next conversion overtakes it
  };

  ConverterSource(ConverterSettings settings, ConverterWires wires, hal::Clock& clock);

  [[nodiscard]] const hal::SourceDescription& do_describe() const noexcept override { return description_; }
  hal::Result<void> do_start() override;
  hal::Result<hal::SampleBlock> do_read(std::int64_t deadline_ns) override;
  void do_stop() noexcept override;
  [[nodiscard]] hal::FrameAccount do_account() const noexcept override { return account_; }
  [[nodiscard]] bool do_recovering() const noexcept override { return recovering_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t do_outages() const noexcept override { return outages_; }
  [[nodiscard]] std::uint64_t do_faults() const noexcept override { return faults_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::vector<hal::Counter> do_counters() const override { return failures_.counters(); }

  // Frames: converter_source.cpp
  [[nodiscard]] hal::Result<hal::SampleBlock> read_or_recover(std::int64_t deadline_ns);
  [[nodiscard]] std::optional<Due> wait_for_edge(std::int64_t deadline_ns);
  void saw_edge(const hal::Edge& edge, hal::DropReason untaken) noexcept;
  [[nodiscard]] std::optional<Due> wait_for_turn(std::int64_t deadline_ns);
  [[nodiscard]] std::optional<hal::SampleBlock> read_frame(const Due& due);
  [[nodiscard]] hal::Result<void> exchange();
  [[nodiscard]] hal::Result<void> exchange_all();
  void count_chips(const frontend::FrameReport& report) noexcept;
  [[nodiscard]] hal::SampleBlock block_of(const Due& due) noexcept;
  void drop(std::uint64_t frames, hal::DropReason reason) noexcept;

  // Wires: converter_recovery.cpp
  [[nodiscard]] hal::Result<void> open_wires();
  void close_wires() noexcept;
  [[nodiscard]] hal::Result<void> set_up();
  [[nodiscard]] hal::Result<void> begin_stream();
  void lose_stream(hal::Error error);
  void recover(std::int64_t deadline_ns);
  [[nodiscard]] hal::Result<void> attempt();
  void attempt_failed(hal::Error error);
  void give_up_when_over(std::int64_t now_ns);
  void count_failed(const hal::Error& error) noexcept;

  ConverterSettings settings_;
  ConverterWires wires_;
  hal::Clock& clock_;
  std::unique_ptr<frontend::FrontEnd> front_end_;
  hal::SourceDescription description_;
  std::vector<std::int32_t> codes_;
  std::vector<std::uint8_t> valid_;
  std::int64_t period_ns_ = 1, silence_ns_ = 1;
  bool wires_open_ = false;

  hal::FrameAccount account_;
  ConverterFailures failures_;
  std::atomic<bool> recovering_{false};
  std::atomic<std::uint64_t> faults_{0};
  std::uint64_t outages_ = 0;

  EdgePace pace_;
  std::optional<hal::Edge> frame_edge_;  // of the frame that is due
  std::int64_t turn_ns_ = 0;             // of the next frame that the host asks for
  std::int64_t last_frame_ns_ = 0;       // when a frame last came, whatever was in it
  std::uint64_t overruns_ = 0;           // told in the next block
  int frames_of_stream_ = 0;             // delivered since the chips were set up
  int bad_frames_ = 0;                   // in a row

  bool streaming_ = false, in_outage_ = false, given_up_ = false;
  std::int64_t outage_ns_ = 0, resume_ns_ = 0;
  int attempts_ = 0;  // in this outage
  BackOff back_off_;
  hal::Error last_error_;
};

}  // namespace compueye::device
