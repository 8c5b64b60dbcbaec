// The frames of device::DeviceSource.

#include "drivers/device/device_source.hpp"

#include <algorithm>
#include <random>
#include <utility>

#include "drivers/protocol/bus.hpp"
#include "hal/try.hpp"

namespace compueye::device {
namespace {

constexpr std::size_t least_chunk_bytes = 65536;
// Looks at a stream that bring no frame, after which the reader pauses: frames take fewer, whatever comes in their
// place does not get all the processor's time, and a transport that answers at once with nothing does not stop the
// clock.
constexpr int most_looks = 1000;
constexpr std::int64_t look_pause_ns = 1'000'000;
constexpr BackOffSettings time_pauses{50'000'000, 10'000'000'000};

/// What one read of the transport gets.
std::size_t chunk_bytes(const protocol::Bus& bus, std::size_t max_packet) {
  if (bus.report_bytes > 0) return bus.report_bytes;
  const std::size_t packet = std::clamp<std::size_t>(max_packet, 1, least_chunk_bytes);
  return (least_chunk_bytes + packet - 1) / packet * packet;
}

std::uint32_t random_config_id() {
  std::random_device device;
  return static_cast<std::uint32_t>(device()) | 1U;
}

}  // namespace

hal::Result<std::unique_ptr<DeviceSource>> DeviceSource::create(DeviceSettings settings,
                                                                std::unique_ptr<hal::ByteTransport> transport,
                                                                hal::Clock& clock) {
  TRY(check_settings(settings));
  if (!transport) return hal::fail(hal::ErrorCode::usage, settings.serial, "an eye needs a transport to be read over");
  std::unique_ptr<DeviceSource> source(new DeviceSource(std::move(settings), std::move(transport), clock));
  TRY(source->get_to(MachineState::configure, source->settings_.start_limit_ns));
  const DeviceSettings& wanted = source->settings_;
  const protocol::DeviceDescriptor& device = *source->descriptor_;
  auto configuration = TRY(configuration_for(wanted, device));
  configuration.config_id = wanted.first_config_id != 0 ? wanted.first_config_id - 1 : random_config_id();
  source->configuration_ = configuration;
  source->description_ = device.source_description(wanted.bus->name, configuration.frame_rate_mhz * 1e-3);
  const std::int64_t usual_ns = std::max<std::int64_t>(5 * configuration.period_ns(), 50'000'000);
  source->silence_ns_ = wanted.silence_ns != 0 ? wanted.silence_ns : usual_ns;
  source->reader_ = make_stream_reader(wanted.bus->framing, device);
  source->chunk_.resize(chunk_bytes(*wanted.bus, source->transport_->describe().max_packet));
  const std::size_t frame = protocol::frame_size(*wanted.bus, device, configuration.format).bytes;
  source->babble_bytes_ = 4 * frame + 1024;
  source->late_reads_ = static_cast<int>(frame / source->chunk_.size()) + 2;
  return source;
}

DeviceSource::DeviceSource(DeviceSettings settings, std::unique_ptr<hal::ByteTransport> transport, hal::Clock& clock)
    : settings_(std::move(settings)),
      transport_(std::move(transport)),
      clock_(clock),
      requests_(*transport_, clock_),
      machine_(settings_.back_off),
      serial_(settings_.serial),
      ask_time_pause_(time_pauses) {}

DeviceSource::~DeviceSource() {
  stop();
  transport_->close();
}

hal::Result<void> DeviceSource::set_exposure(std::int64_t exposure_ns) {
  if (started()) return hal::fail(hal::ErrorCode::usage, serial_, "exposure cannot be set while frames come");
  DeviceSettings wanted = settings_;
  wanted.exposure_ns = exposure_ns;
  TRY(check_settings(wanted));
  const auto configuration = TRY(configuration_for(wanted, *descriptor_));
  configuration_.exposure_ns = configuration.exposure_ns;
  settings_.exposure_ns = exposure_ns;
  return {};
}

hal::Result<void> DeviceSource::set_illumination(const protocol::Illumination& wanted) {
  if (!transport_open_) return hal::fail(hal::ErrorCode::disconnected, serial_, "is not there to be lit");
  return requests_.set_illumination(wanted, clock_.now_ns() + protocol::control_deadline_ns);
}

hal::Result<void> DeviceSource::do_start() {
  failures_ = {};
  reader_->begin_run();
  extent_ = {};
  clock_anew_ = false;
  stream_base_ = stream_overruns_ = estimated_ = 0;
  auto reached = get_to(MachineState::read, settings_.start_limit_ns);
  machine_.run_with(settings_.recovery_limit_ns);
  recovering_.store(false, std::memory_order_relaxed);
  run_config_id_ = configuration_.config_id;
  count_faults();
  return reached;
}

hal::Result<hal::SampleBlock> DeviceSource::do_read(std::int64_t deadline_ns) {
  auto block = read_or_recover(deadline_ns);
  count_faults();
  return block;
}

void DeviceSource::count_faults() noexcept {
  faults_.store(failures().faults(), std::memory_order_relaxed);
}

hal::Result<hal::SampleBlock> DeviceSource::read_or_recover(std::int64_t deadline_ns) {
  int late_reads = 0;
  for (int looks = 1;; ++looks) {
    if (looks % most_looks == 0) clock_.sleep_until_ns(std::min(clock_.now_ns() + look_pause_ns, deadline_ns));
    const std::int64_t now_ns = clock_.now_ns();
    const Order order = machine_.next(now_ns);
    if (order == Order::none) return tl::unexpected(given_up(deadline_ns));
    if (now_ns >= deadline_ns && (order != Order::read || late_reads++ >= late_reads_)) return hal::timed_out();
    if (order != Order::read) {
      carry_out(order, deadline_ns);
      continue;
    }
    const std::size_t bytes_before = bytes_since_frame_;
    if (const auto block = read_stream(deadline_ns)) return *block;
    if (now_ns >= deadline_ns && bytes_since_frame_ == bytes_before) return hal::timed_out();
  }
}

/// The frame at hand, or one look at the stream.
std::optional<hal::SampleBlock> DeviceSource::read_stream(std::int64_t deadline_ns) {
  if (auto block = reader_->take()) {
    saw_frame(*block);
    return block;
  }
  if (held_bytes_ > 0) {
    hand_over(deadline_ns);
    return std::nullopt;
  }
  const std::int64_t now_ns = clock_.now_ns();
  if (!quiet_since_ns_) quiet_since_ns_ = now_ns;
  if (bytes_since_frame_ > babble_bytes_ && quiet_for_too_long()) {
    fail_quiet();
    return std::nullopt;
  }
  if (reader_->has_more()) return std::nullopt;
  const std::int64_t silent_ns = *quiet_since_ns_ + silence_ns_;
  look_began_ns_ = now_ns;
  const auto got = transport_->read(chunk_, std::min(deadline_ns, silent_ns));
  saw_there(got);
  waited_ = waited(clock_.now_ns());
  if (got && extent_.unseen(clock_.now_ns()) >= reader_->most_ahead()) {
    fail(Failure::late_reader,
         {hal::ErrorCode::timeout, serial_, "nobody read it for so long that frames have no number"});
  } else if (got) {
    held_bytes_ = std::min(*got, chunk_.size());
    bytes_since_frame_ += held_bytes_;
    times_held_ = 0;
    hand_over(deadline_ns);
  } else if (got.error().code == hal::ErrorCode::disconnected) {
    fail(Failure::unplugged, got.error());
  } else if (got.error().code != hal::ErrorCode::timeout) {
    fail(Failure::stream_failed, got.error());
  } else if (quiet_for_too_long()) {
    fail_quiet();
  }
  return std::nullopt;
}

/// No frame for too long: with bytes that were none, or without.
void DeviceSource::fail_quiet() {
  if (bytes_since_frame_ > babble_bytes_) {
    lost_as_ = hal::DropReason::corrupt;
    fail(Failure::babble, {hal::ErrorCode::bad_format, serial_, "it sends bytes that are no frames"});
  } else {
    fail(Failure::silence, {hal::ErrorCode::timeout, serial_, "no frames come"});
  }
}

void DeviceSource::saw_frame(hal::SampleBlock& block) noexcept {
  block.config_id = run_config_id_;
  if (std::exchange(clock_anew_, false)) block.flags.time_ok = false;
  machine_.saw_frame();
  recovering_.store(false, std::memory_order_relaxed);
  extent_.saw_frame(block.frame - stream_base_, clock_.now_ns(), waited_);
  quiet_since_ns_.reset();
  bytes_since_frame_ = 0;
  if (!block.flags.time_ok) ++failures_[Failure::doubtful_time];
}

/// Gives the chunk to the reader, once the time of its frame is known if it needs one.
void DeviceSource::hand_over(std::int64_t deadline_ns) {
  constexpr int most_times_held = 4;
  if (reader_->needs_time() && !ask_time(deadline_ns) && ++times_held_ < most_times_held) return;
  reader_->push(std::span<const std::byte>(chunk_).first(std::exchange(held_bytes_, 0)),
                extent_.most_exposed(clock_.now_ns()));
}

/// False when the deadline came first. Frames without a time are better than none: a device that does not answer is
/// asked ever less often.
bool DeviceSource::ask_time(std::int64_t deadline_ns) {
  const std::int64_t now_ns = clock_.now_ns();
  if (now_ns < ask_time_ns_) return true;
  if (now_ns >= deadline_ns) return false;
  look_began_ns_ = now_ns;
  const auto status = requests_.status(deadline_ns);
  saw_there(status);
  if (status) {
    if (status->config_id == configuration_.config_id) reader_->set_time(*status);
    ask_time_pause_.reset();
    return true;
  }
  if (requests_.cut_short()) return false;
  if (status.error().code == hal::ErrorCode::disconnected) {
    saw_gone(clock_.now_ns());
    return true;  // read() will see it, too
  }
  ++failures_[status.error().code == hal::ErrorCode::timeout ? Failure::request_timeout : Failure::request_refused];
  ask_time_ns_ = clock_.now_ns() + ask_time_pause_.next_ns();
  return true;
}

bool DeviceSource::quiet_for_too_long() const noexcept {
  return quiet_since_ns_ && clock_.now_ns() - *quiet_since_ns_ >= silence_ns_;
}

void DeviceSource::do_stop() noexcept {
  const bool reading = machine_.state() == MachineState::read;
  const hal::DropReason reason = reading ? hal::DropReason::stopped : lost_as_;
  static_cast<void>(end_stream(reason, clock_.now_ns() + 2 * protocol::control_deadline_ns));
  if (extent_.is_open()) close_stream(extent_.close(clock_.now_ns()), reason);
  count_faults();
}

/// Stops the device and asks it how many frames there were. False: `until_ns` came before its answer.
bool DeviceSource::end_stream(hal::DropReason reason, std::int64_t until_ns) {
  if (!extent_.is_open()) return true;
  if (machine_.is_open()) {
    const bool stopped = requests_.order(protocol::Request::stop, until_ns).has_value();
    if (!stopped && requests_.cut_short()) return false;
    const auto status = requests_.status(until_ns);
    if (!status && requests_.cut_short()) return false;
    if (stopped && status) {
      close_stream(extent_.close(*status, clock_.now_ns()), reason);
      return true;
    }
  }
  close_stream(extent_.close(clock_.now_ns()), reason);
  return true;
}

/// Of the frames that the device made in a stream, those that did not come are dropped.
void DeviceSource::close_stream(const StreamExtent::Frames& frames, hal::DropReason reason) noexcept {
  reader_->stop(reason);
  const std::uint64_t come = reader_->account().produced - stream_base_;
  const std::uint64_t missing = frames.made > come ? frames.made - come : 0;
  const std::uint64_t known = reader_->account().drops(hal::DropReason::device_overrun) - stream_overruns_;
  const std::uint64_t overrun = std::min(missing, frames.overrun > known ? frames.overrun - known : 0);
  reader_->lose(overrun, hal::DropReason::device_overrun);
  reader_->lose(missing - overrun, reason);
  if (frames.estimated) estimated_ += missing;
}

hal::FrameAccount DeviceSource::do_account() const noexcept {
  hal::FrameAccount account = reader_->account();
  account.estimated = estimated_;
  return account;
}

FailureCounters DeviceSource::failures() const noexcept {
  FailureCounters failures = failures_;
  reader_->add_failures(failures);
  return failures;
}

}  // namespace compueye::device
