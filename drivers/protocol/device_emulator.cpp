#include "drivers/protocol/device_emulator.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>

#include "drivers/protocol/little_endian.hpp"
#include "hal/try.hpp"

namespace compueye::protocol {
namespace {

constexpr std::int64_t forever = std::numeric_limits<std::int64_t>::max();
constexpr std::size_t room_for_events = 512;

std::int64_t until(std::int64_t now_ns, std::int64_t duration_ns) noexcept {
  return duration_ns <= 0 || duration_ns > forever - now_ns ? forever : now_ns + duration_ns;
}

/// Bytes of the FIFO that the widest frame takes.
std::size_t most_frame_bytes(const EmulatorSettings& settings) {
  return frame_size(*settings.bus, settings.descriptor, SampleFormat::i24).bytes +
         (settings.events ? room_for_events : 0);
}

hal::Result<void> check_settings(const EmulatorSettings& settings) {
  const DeviceDescriptor& d = settings.descriptor;
  const auto refuse = [&](std::string sentence) {
    return hal::fail(hal::ErrorCode::out_of_range, d.serial, std::move(sentence));
  };
  const Bus& bus = *settings.bus;
  if (!bus.carries(d) || (bus.only_format && !d.offers(*bus.only_format))) {
    return refuse(std::string(bus.title) + " carries at most " + std::to_string(bus.most_channels) + " channels of " +
                  std::to_string(bus.most_bits) + " bits" +
                  (bus.only_format ? " as " + std::string(name(*bus.only_format)) : ""));
  }
  if (settings.fifo_bytes < most_frame_bytes(settings)) {
    return refuse("a FIFO of " + std::to_string(settings.fifo_bytes) +
                  " bytes does not hold a frame, which takes up to " + std::to_string(most_frame_bytes(settings)));
  }
  return {};
}

}  // namespace

std::string_view name(FaultKind kind) noexcept {
  constexpr std::array<std::string_view, fault_kind_count> names{
      "silence",       "control_silence", "stall_stream",      "stall_control", "short_read",  "bit_error",
      "wrong_echo",    "unplug",          "replug_other",      "clock_jump",    "reboot",      "babble",
      "other_version", "lose_packets",    "duplicate_packets", "overrun",       "lose_answers"};
  return names[static_cast<std::size_t>(kind)];
}

hal::Result<DeviceEmulator> DeviceEmulator::create(EmulatorSettings settings, SampleGenerator generator,
                                                   std::int64_t now_ns) {
  if (!generator) {
    return hal::fail(hal::ErrorCode::usage, settings.descriptor.serial, "an emulated eye needs a generator of samples");
  }
  auto bytes = TRY(serialise(settings.descriptor));
  settings.events = settings.events && settings.bus->framing == Framing::packets;
  TRY(check_settings(settings));
  if (settings.link_bytes_per_s <= 0.0) settings.link_bytes_per_s = settings.bus->emulated_bytes_per_s;
  return DeviceEmulator(std::move(settings), std::move(generator), std::move(bytes), now_ns);
}

DeviceEmulator::DeviceEmulator(EmulatorSettings settings, SampleGenerator generator,
                               std::vector<std::byte> descriptor_bytes, std::int64_t now_ns)
    : settings_(std::move(settings)),
      generator_(std::move(generator)),
      descriptor_(settings_.descriptor),
      descriptor_bytes_(std::move(descriptor_bytes)),
      fifo_(settings_.fifo_bytes),
      codes_(static_cast<std::size_t>(descriptor_.channels)),
      packet_(least_packet_bytes + most_payload_bytes),
      random_(settings_.seed),
      now_ns_(now_ns),
      levels_(descriptor_.illuminators.size()) {
  for (EmulatorFault& fault : settings_.faults) inject(std::move(fault));
  boot(now_ns - settings_.boot_ns);  // plugged in a while ago
}

void DeviceEmulator::advance(std::int64_t now_ns) {
  for (;;) {
    const auto fault_ns = next_fault_ns();
    const std::int64_t back_ns = comes_back_ns_.value_or(forever);
    const std::int64_t frame_ns = state_ == DeviceState::streaming ? frame_ready_ns() : forever;
    const std::int64_t next_ns = std::min({fault_ns.value_or(forever), back_ns, frame_ns});
    if (next_ns > now_ns || next_ns == forever) break;
    now_ns_ = std::max(now_ns_, next_ns);
    if (fault_ns && *fault_ns <= next_ns) {
      begin_faults(now_ns_);
    } else if (back_ns <= next_ns) {
      come_back(next_ns);
    } else {
      expose(frame_ns);
      overrun_until(std::min({fault_ns.value_or(forever), back_ns, now_ns}));
    }
  }
  now_ns_ = std::max(now_ns_, now_ns);
}

std::optional<std::int64_t> DeviceEmulator::next_fault_ns() const noexcept {
  std::optional<std::int64_t> next;
  for (const Scripted& each : faults_) {
    if (each.begun || each.fault.at_frame) continue;
    if (!next || each.fault.at_ns < *next) next = each.fault.at_ns;
  }
  return next;
}

void DeviceEmulator::begin_faults(std::int64_t now_ns) {
  for (Scripted& each : faults_) {
    if (each.begun || each.fault.at_frame || each.fault.at_ns > now_ns) continue;
    each.begun = true;
    begin(each.fault, now_ns);
  }
}

void DeviceEmulator::begin(const EmulatorFault& fault, std::int64_t now_ns) {
  ++truth_.faults[static_cast<std::size_t>(fault.kind)];
  switch (fault.kind) {
    case FaultKind::unplug:
    case FaultKind::replug_other:
      return take_away(fault, now_ns);
    case FaultKind::clock_jump:
      clock_step_ns_ = std::max(clock_step_ns_ + fault.value, boot_ns_ - now_ns);  // a clock has no negative time
      clock_was_set_ = true;
      return;
    case FaultKind::reboot:
      return reboot(fault, now_ns);
    case FaultKind::other_version:
      descriptor_.version = ProtocolVersion::from_byte(static_cast<std::uint8_t>(fault.value));
      return describe_anew();
    case FaultKind::wrong_echo:
      now_wrong_.wrong_echoes += fault.count;
      return;
    case FaultKind::overrun:
      now_wrong_.frames_to_overrun += fault.count;
      return;
    case FaultKind::lose_answers:
      now_wrong_.lost_answers += fault.count;
      return;
    case FaultKind::control_silence:
      now_wrong_.control_silent_until_ns = until(now_ns, fault.duration_ns);
      return;
    case FaultKind::stall_control:
      now_wrong_.stalled_requests += fault.count;
      now_wrong_.control_stalled = fault.count == 0;
      return;
    default:
      begin_link_fault(fault, now_ns);
  }
}

void DeviceEmulator::begin_link_fault(const EmulatorFault& fault, std::int64_t now_ns) noexcept {
  switch (fault.kind) {
    case FaultKind::silence:
      now_wrong_.silent_until_ns = until(now_ns, fault.duration_ns);
      return;
    case FaultKind::stall_stream:
      now_wrong_.stream_halted = true;
      return;
    case FaultKind::babble:
      now_wrong_.babble_until_ns = until(now_ns, fault.duration_ns);
      babbled_ns_ = now_ns;
      return;
    case FaultKind::short_read:
      now_wrong_.short_packets += fault.count;
      return;
    case FaultKind::bit_error:
      now_wrong_.bit_errors += fault.count;
      return;
    case FaultKind::lose_packets:
      now_wrong_.lost_packets += fault.count;
      return;
    case FaultKind::duplicate_packets:
      now_wrong_.duplicates += fault.count;
      return;
    default:
      return;
  }
}

void DeviceEmulator::take_away(const EmulatorFault& fault, std::int64_t now_ns) {
  stop();
  attached_ = false;
  comes_back_ns_.reset();
  if (fault.duration_ns > 0) comes_back_ns_ = until(now_ns, fault.duration_ns);
  comes_back_as_ = descriptor_.serial;
  if (fault.kind == FaultKind::replug_other) comes_back_as_ = fault.text.empty() ? "other" : fault.text;
}

void DeviceEmulator::come_back(std::int64_t now_ns) {
  comes_back_ns_.reset();
  attached_ = true;
  ++attachment_;
  descriptor_.serial = comes_back_as_;
  describe_anew();
  boot(now_ns);
}

/// Only called with a descriptor that was right before, and a serial that a test has chosen.
void DeviceEmulator::describe_anew() {
  if (auto bytes = serialise(descriptor_)) descriptor_bytes_ = std::move(*bytes);
}

void DeviceEmulator::boot(std::int64_t now_ns) noexcept {
  stop();
  ++truth_.boots;
  if (descriptor_.serial == settings_.descriptor.serial) ++boot_count_;  // another device counts its own
  boot_ns_ = now_ns;
  clock_step_ns_ = 0;
  clock_was_set_ = false;
  now_wrong_ = {};
  state_ = DeviceState::idle;
  last_error_ = StatusError::none;
  refused_ = 0;
  configuration_ = {};
  stream_config_id_ = 0;
  frame_ = 0;
  seq_ = dropped_ = 0;
  std::fill(levels_.begin(), levels_.end(), std::uint16_t{0});
  illumination_ = {};
  settled_ns_ = std::numeric_limits<std::int64_t>::min();
  settling_ = false;
  hid_page_ = {};
  hid_nonce_ = hid_last_request_ = 0;
}

void DeviceEmulator::reboot(const EmulatorFault& fault, std::int64_t now_ns) noexcept {
  const Configuration before = configuration_;
  StreamFifo half = std::move(fifo_);
  half.cut();
  boot(now_ns);
  fifo_ = std::move(half);
  if (fault.value != 1 || before.frame_rate_mhz == 0) return;
  configuration_ = before;
  configuration_.config_id = 0;
  begin_stream(now_ns, 0);
}

std::uint64_t DeviceEmulator::clock_ns(std::int64_t now_ns) const noexcept {
  return static_cast<std::uint64_t>(std::max<std::int64_t>(now_ns - boot_ns_ + clock_step_ns_, 0));
}

DeviceEmulator::Transfer DeviceEmulator::read(std::int64_t now_ns, std::span<std::byte> into) {
  advance(now_ns);
  if (!attached_) return {Outcome::gone, 0};
  if (now_wrong_.stream_halted) return {Outcome::stalled, 0};
  if (now_ns < now_wrong_.silent_until_ns) return {Outcome::nothing, 0};
  const std::size_t bytes = now_ns < now_wrong_.babble_until_ns
                                ? babble(now_ns, into)
                                : fifo_.read(now_ns, into, settings_.bus->report_bytes > 0);
  return {bytes > 0 ? Outcome::done : Outcome::nothing, bytes};
}

std::size_t DeviceEmulator::babble(std::int64_t now_ns, std::span<std::byte> into) noexcept {
  const double allowed = static_cast<double>(now_ns - babbled_ns_) * 1e-9 * settings_.link_bytes_per_s;
  std::size_t bytes = std::min(into.size(), static_cast<std::size_t>(std::min(allowed, 1e6)));
  if (const std::size_t report = settings_.bus->report_bytes; report > 0) bytes = bytes < report ? 0 : report;
  if (bytes == 0) return 0;
  babbled_ns_ = now_ns;
  for (std::size_t at = 0; at < bytes; at += sizeof(std::uint64_t)) {
    std::uint64_t word = random_();
    if (word % 64 == 0) word = packet_magic;  // the worst garbage is what looks like a beginning
    std::byte little[sizeof word];
    store_little(little, word);
    std::memcpy(into.data() + at, little, std::min(sizeof little, bytes - at));
  }
  return bytes;
}

std::optional<std::int64_t> DeviceEmulator::next_change_ns(std::int64_t now_ns) const noexcept {
  std::int64_t next = forever;
  const auto consider = [&](std::int64_t at_ns) {
    if (at_ns > now_ns) next = std::min(next, at_ns);
  };
  if (const auto fault_ns = next_fault_ns()) consider(std::max(*fault_ns, now_ns + 1));
  if (comes_back_ns_) consider(*comes_back_ns_);
  if (attached_) {
    if (state_ == DeviceState::streaming) consider(frame_ready_ns());
    consider(now_wrong_.silent_until_ns);
    consider(now_wrong_.babble_until_ns);
    if (const auto ready_ns = fifo_.available_ns()) consider(*ready_ns);
    if (now_ns < now_wrong_.babble_until_ns) {
      consider(now_ns +
               static_cast<std::int64_t>(static_cast<double>(hid_report_bytes) / settings_.link_bytes_per_s * 1e9) + 1);
    }
  }
  if (next == forever) return std::nullopt;
  return next;
}

void DeviceEmulator::reset_bus(std::int64_t now_ns) {
  advance(now_ns);
  if (!attached_) return;
  ++truth_.bus_resets;
  stop();
  now_wrong_.stream_halted = false;
  now_wrong_.control_stalled = false;
  now_wrong_.control_silent_until_ns = 0;
  now_wrong_.babble_until_ns = 0;
}

bool DeviceEmulator::attached(std::int64_t now_ns) {
  advance(now_ns);
  return attached_;
}

std::uint64_t DeviceEmulator::attachment(std::int64_t now_ns) {
  advance(now_ns);
  return attachment_;
}

}  // namespace compueye::protocol
