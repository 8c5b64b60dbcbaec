#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "drivers/protocol/bus.hpp"
#include "drivers/protocol/configuration.hpp"
#include "drivers/protocol/descriptor.hpp"
#include "drivers/protocol/descriptor_pages.hpp"
#include "drivers/protocol/emulator_faults.hpp"
#include "drivers/protocol/frame_header.hpp"
#include "drivers/protocol/hid_control.hpp"
#include "drivers/protocol/requests.hpp"
#include "drivers/protocol/status.hpp"
#include "drivers/protocol/stream_fifo.hpp"
#include "hal/result.hpp"

namespace compueye::protocol {

/// What a sample generator is told about the frame whose samples it makes.
struct EmulatedExposure {
  std::uint64_t frame = 0;    ///< since START, from 0
  std::int64_t start_ns = 0;  ///< emulator time
  std::int64_t exposure_ns = 0;
  std::span<const std::uint16_t> levels;  ///< of the illuminators, in the descriptor's order
};

/// Fills M codes, 0 .. 2^bits - 1, in channel order. Called once for every frame that is kept.
using SampleGenerator = std::function<void(const EmulatedExposure&, std::span<std::int32_t> codes)>;

struct EmulatorSettings {
  DeviceDescriptor descriptor;
  const Bus* bus = &usb_bus;                         ///< never null
  std::size_t fifo_bytes = std::size_t{256} * 1024;  ///< at least one frame of the widest format offered
  double link_bytes_per_s = 0.0;                     ///< 0: those of the bus
  bool events = true;                 ///< log and event packets between the data, where there are packets
  std::int64_t boot_ns = 50'000'000;  ///< from power-on or reboot to the first answer
  std::uint64_t seed = 1;             ///< of damaged bits and garbage
  std::vector<EmulatorFault> faults;
};

/// What truly happened, over all streams, for tests to hold a host's account against.
struct EmulatorTruth {
  std::uint64_t frames = 0;           ///< exposed
  std::uint64_t frames_overrun = 0;   ///< of them dropped for want of memory
  std::uint64_t frames_unasked = 0;   ///< of them in a stream that no host has started, after a reboot
  std::uint64_t packets = 0;          ///< or reports, given to the link
  std::uint64_t packets_lost = 0;     ///< by lose_packets
  std::uint64_t packets_damaged = 0;  ///< by bit_error and short_read
  std::uint64_t starts = 0, boots = 0, bus_resets = 0;
  std::array<std::uint64_t, fault_kind_count> faults{};  ///< begun, by FaultKind
};

/// A device after docs/protocol.md, as a state machine in a time that is an argument: idle -> configured -> streaming,
/// requests, frames out of a sample generator, a FIFO that overruns, illumination that settles, and a script of faults.
/// Time must not go backwards between calls. One thread. Once streaming, reads allocate nothing (faults may).
class DeviceEmulator {
 public:
  /// Errors: those of check_descriptor(); usage (no generator); out_of_range (FIFO smaller than a frame, an eye too
  /// large or deep for the bus).
  [[nodiscard]] static hal::Result<DeviceEmulator> create(EmulatorSettings settings, SampleGenerator generator,
                                                          std::int64_t now_ns = 0);

  enum class Outcome : std::uint8_t {
    done,     ///< `bytes` were transferred
    nothing,  ///< no answer, no data: the host will time out
    stalled,  ///< refused, or the endpoint is halted
    gone,     ///< not plugged in
  };
  struct Transfer {
    Outcome outcome = Outcome::nothing;
    std::size_t bytes = 0;
  };

  /// A vendor request on EP0 (USB), as hal::ByteTransport::control().
  Transfer control(std::int64_t now_ns, std::uint8_t request, std::span<const std::byte> payload,
                   std::span<std::byte> reply);
  /// Feature reports (HID), 64 bytes with their id first.
  Transfer set_feature(std::int64_t now_ns, std::span<const std::byte> report);
  Transfer get_feature(std::int64_t now_ns, std::uint8_t id, std::span<std::byte> report);
  /// The stream: what is ready of it on USB, one input report on HID.
  Transfer read(std::int64_t now_ns, std::span<std::byte> into);
  /// The host resets the bus (as when a program opens the device): stream stopped, endpoints and control channel clear.
  void reset_bus(std::int64_t now_ns);

  /// The earliest time after `now_ns` at which read() could have something new; nothing when only a request can change
  /// that.
  [[nodiscard]] std::optional<std::int64_t> next_change_ns(std::int64_t now_ns) const noexcept;

  [[nodiscard]] bool attached(std::int64_t now_ns);
  /// Counts pluggings-in, so that a handle from before an unplugging can be told.
  [[nodiscard]] std::uint64_t attachment(std::int64_t now_ns);
  [[nodiscard]] const std::string& serial() const noexcept { return descriptor_.serial; }
  [[nodiscard]] const DeviceDescriptor& descriptor() const noexcept { return descriptor_; }
  [[nodiscard]] const Bus& bus() const noexcept { return *settings_.bus; }
  [[nodiscard]] DeviceState state() const noexcept { return state_; }
  [[nodiscard]] const EmulatorTruth& truth() const noexcept { return truth_; }

  /// Adds a line to the script; one whose time has passed happens at the next call.
  void inject(EmulatorFault fault) {
    std::erase_if(faults_, [](const Scripted& each) { return each.begun; });
    faults_.push_back({std::move(fault), false});
  }

 private:
  DeviceEmulator(EmulatorSettings settings, SampleGenerator generator, std::vector<std::byte> descriptor_bytes,
                 std::int64_t now_ns);

  struct Scripted {
    EmulatorFault fault;
    bool begun = false;
  };
  /// What the faults that have begun still do.
  struct Afflictions {
    std::int64_t silent_until_ns = 0, control_silent_until_ns = 0, babble_until_ns = 0;
    bool stream_halted = false;
    bool control_stalled = false;
    std::uint64_t stalled_requests = 0;
    std::uint64_t short_packets = 0, bit_errors = 0, lost_packets = 0, duplicates = 0, wrong_echoes = 0;
    std::uint64_t lost_answers = 0;
    std::uint64_t frames_to_overrun = 0;
  };

  // Time and faults: device_emulator.cpp
  void advance(std::int64_t now_ns);
  [[nodiscard]] std::optional<std::int64_t> next_fault_ns() const noexcept;
  void begin_faults(std::int64_t now_ns);
  void begin(const EmulatorFault& fault, std::int64_t now_ns);
  void begin_link_fault(const EmulatorFault& fault, std::int64_t now_ns) noexcept;
  void describe_anew();
  void boot(std::int64_t now_ns) noexcept;
  void take_away(const EmulatorFault& fault, std::int64_t now_ns);
  void come_back(std::int64_t now_ns);
  void reboot(const EmulatorFault& fault, std::int64_t now_ns) noexcept;
  [[nodiscard]] std::size_t babble(std::int64_t now_ns, std::span<std::byte> into) noexcept;
  [[nodiscard]] std::uint64_t clock_ns(std::int64_t now_ns) const noexcept;

  // Requests: emulator_control.cpp
  [[nodiscard]] std::optional<Outcome> unreachable(std::int64_t now_ns) noexcept;
  Transfer delivered(Transfer answer) noexcept;
  Transfer answer(std::int64_t now_ns, Request request, std::span<const std::byte> payload, std::span<std::byte> reply);
  Transfer refuse(StatusError why) noexcept;
  Transfer set_configuration(std::span<const std::byte> payload);
  Transfer get_configuration(std::span<std::byte> reply) noexcept;
  Transfer start(std::int64_t now_ns) noexcept;
  void begin_stream(std::int64_t now_ns, std::uint32_t config_id) noexcept;
  void stop() noexcept;
  Transfer set_illumination(std::int64_t now_ns, std::span<const std::byte> payload) noexcept;
  [[nodiscard]] Transfer descriptor_page(std::span<const std::byte> payload, std::span<std::byte> reply) const noexcept;
  [[nodiscard]] Status status(std::int64_t now_ns) const noexcept;

  // Frames: emulator_frames.cpp
  void expose(std::int64_t ready_ns);
  void overrun_until(std::int64_t t_ns) noexcept;
  void send_packets(std::int64_t ready_ns, std::uint64_t frame, std::int64_t start_ns);
  void send_reports(std::int64_t ready_ns, std::int64_t start_ns);
  void send_events(std::int64_t ready_ns, const FrameHeader& header);
  void send_event(std::int64_t ready_ns, FrameHeader header, PacketType type, std::span<const std::byte> payload);
  void give_to_link(std::int64_t ready_ns, std::span<std::byte> packet) noexcept;
  [[nodiscard]] bool frame_fits() const noexcept;
  [[nodiscard]] bool dark(std::int64_t start_ns) const noexcept;
  [[nodiscard]] std::uint8_t illum(std::int64_t start_ns) const noexcept;
  [[nodiscard]] std::int64_t exposure_start_ns(std::uint64_t frame) const noexcept {
    return stream_start_ns_ + static_cast<std::int64_t>(frame) * period_ns_;
  }
  [[nodiscard]] std::int64_t frame_ready_ns() const noexcept { return exposure_start_ns(frame_ + 1); }

  EmulatorSettings settings_;
  SampleGenerator generator_;
  DeviceDescriptor descriptor_;
  std::vector<std::byte> descriptor_bytes_;
  StreamFifo fifo_;
  std::vector<std::int32_t> codes_;
  std::vector<std::byte> packet_;
  std::vector<Scripted> faults_;
  Afflictions now_wrong_;
  std::mt19937_64 random_;
  EmulatorTruth truth_;

  std::int64_t now_ns_ = 0;
  bool attached_ = true;
  std::optional<std::int64_t> comes_back_ns_;
  std::string comes_back_as_;
  std::uint64_t attachment_ = 1;
  std::int64_t boot_ns_ = 0;  // when the firmware started
  std::uint32_t boot_count_ = 0;
  std::int64_t clock_step_ns_ = 0;
  bool clock_was_set_ = false;

  DeviceState state_ = DeviceState::idle;
  StatusError last_error_ = StatusError::none;
  std::uint32_t refused_ = 0;
  Configuration configuration_;
  std::uint32_t stream_config_id_ = 0;
  std::int64_t stream_start_ns_ = 0, period_ns_ = 0;
  std::uint64_t frame_ = 0;      // the next one
  std::uint64_t last_t_ns_ = 0;  ///< of the last frame, by the clock as it was then
  std::uint32_t seq_ = 0;
  std::uint32_t dropped_ = 0;
  bool overrun_pending_ = false;
  std::int64_t link_free_ns_ = 0;
  std::int64_t babbled_ns_ = 0;

  std::vector<std::uint16_t> levels_;
  Illumination illumination_;
  std::int64_t settled_ns_ = 0;
  bool settling_ = false;

  PageRequest hid_page_;
  std::uint32_t hid_nonce_ = 0;
  std::uint8_t hid_last_request_ = 0;
};

}  // namespace compueye::protocol
