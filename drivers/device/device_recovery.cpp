// The set-up and recovery of device::DeviceSource.

#include <algorithm>
#include <utility>

#include "hal/try.hpp"

#include "drivers/device/device_source.hpp"

namespace compueye::device {
namespace {

/// What a request that failed with `code` says about the device.
Failure failure_of(Order order, hal::ErrorCode code) noexcept {
  switch (code) {
    case hal::ErrorCode::timeout:
      return Failure::request_timeout;
    case hal::ErrorCode::disconnected:
      return Failure::unplugged;
    case hal::ErrorCode::not_found:
      return Failure::absent;
    case hal::ErrorCode::unsupported:
      return Failure::other_version;
    case hal::ErrorCode::mismatch:
      return order == Order::get_config ? Failure::wrong_echo : Failure::bad_reply;
    case hal::ErrorCode::bad_format:
    case hal::ErrorCode::out_of_range:
      return Failure::bad_reply;
    default:
      return order == Order::open ? Failure::open_failed : Failure::request_refused;
  }
}

/// A try of one that the reader's deadline cuts short is made again. START is not: the device may have begun.
bool is_repeated(Order order) noexcept {
  return order != Order::open && order != Order::start;
}

bool is_away(Failure why) noexcept {
  return why == Failure::unplugged || why == Failure::absent || why == Failure::open_failed ||
         why == Failure::other_serial;
}

/// Everything that a run was told about the eye; its firmware's name may have changed.
bool same_eye(const protocol::DeviceDescriptor& a, const protocol::DeviceDescriptor& b) {
  return a.channels == b.channels && a.bits == b.bits && a.formats == b.formats && a.most_payload == b.most_payload &&
         a.ommatidium_of_channel == b.ommatidium_of_channel && a.sample_offset_ns == b.sample_offset_ns;
}

std::string in_seconds(std::int64_t ns) {
  std::string tenths = std::to_string(ns / 100'000'000);
  if (tenths.size() < 2) tenths.insert(0, 1, '0');
  return tenths.insert(tenths.size() - 1, 1, '.') + " s";
}

}  // namespace

/// Carries out orders until the machine is in `state`, for `limit_ns` at most.
hal::Result<void> DeviceSource::get_to(MachineState state, std::int64_t limit_ns) {
  const std::int64_t until_ns = clock_.now_ns() + limit_ns;
  last_error_ = hal::timed_out().value();
  machine_.begin(clock_.now_ns(), limit_ns);
  for (;;) {
    const std::int64_t now_ns = clock_.now_ns();
    const Order order = machine_.next(now_ns);
    if (machine_.state() == state) return {};
    if (order == Order::none) break;
    if (now_ns >= until_ns) {
      if (pages_) last_error_ = too_slow(limit_ns);
      break;
    }
    carry_out(order, std::min(now_ns + protocol::control_deadline_ns, until_ns));
  }
  hal::Error error = last_error_;
  if (error.place.empty()) error.place = serial_.empty() ? transport_->describe().bus : serial_;
  if (error.code == hal::ErrorCode::timeout && error.sentence.empty()) {
    error.sentence = "the eye did not answer for " + in_seconds(limit_ns) + "; unplug it and plug it in again";
  }
  return tl::unexpected(std::move(error));
}

hal::Error DeviceSource::too_slow(std::int64_t limit_ns) const {
  return {hal::ErrorCode::timeout, serial_.empty() ? transport_->describe().bus : serial_,
          "the eye answers, but of its description only " + std::to_string(pages_->bytes().size()) + " bytes came in " +
              in_seconds(limit_ns) + "; its firmware is too slow"};
}

void DeviceSource::carry_out(Order order, std::int64_t until_ns) {
  if (order == Order::pause) return pause(std::min(machine_.resume_ns(), until_ns));
  blame_.reset();
  const std::int64_t began_ns = clock_.now_ns();
  look_began_ns_ = began_ns;
  if (order == Order::descriptor && pages_ && began_ns - pages_ns_ >= settings_.start_limit_ns) {
    return fail(Failure::request_timeout, too_slow(settings_.start_limit_ns));
  }
  auto done = attempt(order, until_ns);
  if (order != Order::open) saw_there(done);
  if (order == Order::descriptor && done && pages_) return;  // the next page
  // Cut short by the reader, a request is made again, and not before the reader's deadline has come; tries that
  // together took a device's whole time are one that failed.
  if (!done && done.error().code == hal::ErrorCode::timeout && is_repeated(order) && requests_.cut_short()) {
    clock_.sleep_until_ns(until_ns);
    unanswered_ns_ += clock_.now_ns() - began_ns;
    if (unanswered_ns_ < protocol::control_deadline_ns) return;
  }
  unanswered_ns_ = 0;
  if (done) {
    if (order == Order::open || order == Order::reset_pipes) extent_.saw_stopped(clock_.now_ns());
    return machine_.done(order, clock_.now_ns());
  }
  const Failure why = blame_.value_or(failure_of(order, done.error().code));
  fail(why, std::move(done.error()));
}

hal::Result<void> DeviceSource::attempt(Order order, std::int64_t until_ns) {
  switch (order) {
    case Order::open:
      return open();
    case Order::reset_pipes:
      pages_.reset();
      return requests_.order(protocol::Request::reset_pipes, until_ns);
    case Order::ping:
      return ping(until_ns);
    case Order::status:
      return look_at_status(until_ns);
    case Order::descriptor:
      return fetch_descriptor(until_ns);
    case Order::set_config:
      next_config_id();
      return requests_.set_configuration(configuration_, until_ns);
    case Order::get_config:
      return compare_echo(until_ns);
    case Order::start: {
      auto started = requests_.order(protocol::Request::start, until_ns);
      // One that timed out may have arrived.
      if (started || started.error().code == hal::ErrorCode::timeout) begin_stream();
      return started;
    }
    case Order::pause:
    case Order::read:
    case Order::none:
      break;
  }
  return {};
}

/// Waits on the old handle as long as there is one, so that an unplugging is seen when it happens.
void DeviceSource::pause(std::int64_t until_ns) {
  if (transport_open_ && extent_.is_open()) {
    look_began_ns_ = clock_.now_ns();
    const auto got = transport_->read(chunk_, until_ns);
    saw_there(got);
    if (got || got.error().code == hal::ErrorCode::timeout) return;
    if (got.error().code == hal::ErrorCode::disconnected) {
      saw_gone(clock_.now_ns());
      close_transport();
    }
  }
  clock_.sleep_until_ns(until_ns);
}

/// A wait that ends so has ended when the device went. After a long time in which nobody looked it may have gone at any
/// time since it was last there, and no frame is invented.
void DeviceSource::saw_gone(std::int64_t now_ns) noexcept {
  const bool just_now = waited(now_ns) || now_ns - there_ns_ <= silence_ns_;
  extent_.saw_gone(just_now ? now_ns : there_ns_);
}

void DeviceSource::close_transport() noexcept {
  transport_->close();
  transport_open_ = false;
}

hal::Result<void> DeviceSource::open() {
  close_transport();
  TRY(transport_->open());
  transport_open_ = true;
  const std::string& found = transport_->describe().serial;
  if (serial_.empty() || found.empty() || found == serial_) return {};
  return other_eye(found);
}

hal::Result<void> DeviceSource::ping(std::int64_t until_ns) {
  const auto pong = TRY(requests_.ping(until_ns));
  // A device that was streaming and was stopped is configured.
  if (pong.state == protocol::DeviceState::idle) extent_.saw_idle();
  return protocol::check_version(pong.version, serial_.empty() ? transport_->describe().bus : serial_);
}

tl::unexpected<hal::Error> DeviceSource::other_eye(const std::string& found) {
  blame_ = Failure::other_serial;
  return hal::fail(hal::ErrorCode::not_found, serial_,
                   "another eye is plugged in, " + found + "; plug " + serial_ + " in");
}

/// What became of the stream before, and whether the device has started anew since the last look.
hal::Result<void> DeviceSource::look_at_status(std::int64_t until_ns) {
  const auto status = TRY(requests_.status(until_ns));
  if (extent_.is_open()) close_stream(extent_.close(status, clock_.now_ns()), lost_as_);
  if (started_anew(status)) ++failures_[Failure::rebooted];
  return {};
}

/// Since the last STATUS, which this one is from now on.
bool DeviceSource::started_anew(const protocol::Status& status) noexcept {
  const bool anew = has_status_ && status.boot_count != status_.boot_count;
  if (anew) {
    machine_.doubt_identity();
    clock_anew_ = true;
  }
  status_ = status;
  has_status_ = true;
  return anew;
}

/// A device that has started anew since SET_CONFIG has no configuration to return: it is not blamed for that.
hal::Result<void> DeviceSource::compare_echo(std::int64_t until_ns) {
  auto same = requests_.check_configuration(configuration_, serial_, until_ns);
  if (same || same.error().code != hal::ErrorCode::mismatch) return same;
  if (started_anew(TRY(requests_.status(until_ns)))) blame_ = Failure::rebooted;
  return same;
}

hal::Result<void> DeviceSource::fetch_descriptor(std::int64_t until_ns) {
  if (!pages_) {
    pages_.emplace(settings_.bus->page_bytes, transport_->describe().bus);
    pages_ns_ = clock_.now_ns();
  }
  TRY(requests_.page(*pages_, until_ns));
  if (!pages_->complete()) return {};
  auto found = protocol::parse_descriptor(pages_->bytes(), transport_->describe().bus);
  pages_.reset();
  if (!found) return tl::unexpected(std::move(found.error()));
  return judge(std::move(*found));
}

hal::Result<void> DeviceSource::judge(protocol::DeviceDescriptor found) {
  if (!serial_.empty() && found.serial != serial_) return other_eye(found.serial);
  if (descriptor_ && !same_eye(*descriptor_, found)) {
    blame_ = Failure::other_descriptor;
    return hal::fail(hal::ErrorCode::mismatch, serial_,
                     "the eye came back with another descriptor: " + std::to_string(found.channels) + " channels of " +
                         std::to_string(found.bits) + " bits, firmware " + found.firmware +
                         "; start the program again to use it as it is now");
  }
  serial_ = found.serial;
  if (!descriptor_) descriptor_ = std::move(found);
  return {};
}

/// Never one whose tag in HID reports is that of an unconfigured device.
void DeviceSource::next_config_id() noexcept {
  ++configuration_.config_id;
  if (configuration_.config_id % 16 == 0) ++configuration_.config_id;
}

void DeviceSource::begin_stream() noexcept {
  const std::int64_t now_ns = clock_.now_ns();
  extent_.begin(configuration_.config_id, status_, now_ns, configuration_.period_ns());
  reader_->begin_stream(configuration_.config_id, configuration_.period_ns());
  stream_base_ = reader_->account().produced;
  stream_overruns_ = reader_->account().drops(hal::DropReason::device_overrun);
  lost_as_ = hal::DropReason::transport_gap;
  quiet_since_ns_.reset();
  bytes_since_frame_ = held_bytes_ = 0;
  farewells_ = 0;
  there_ns_ = now_ns;
  ask_time_ns_ = now_ns;
}

void DeviceSource::fail(Failure why, hal::Error error) {
  const std::int64_t now_ns = clock_.now_ns();
  const bool was_open = machine_.is_open(), was_reading = machine_.state() == MachineState::read;
  ++failures_[why];
  last_error_ = std::move(error);
  if (was_reading) ++failures_[Failure::restart];
  if (is_away(why) && why != Failure::open_failed) saw_gone(now_ns);
  if (quiet_since_ns_) extent_.saw_quiet(*quiet_since_ns_);
  pages_.reset();
  machine_.failed(why, now_ns);
  recovering_.store(machine_.state() != MachineState::given_up, std::memory_order_relaxed);
  if (machine_.state() == MachineState::given_up) {
    ++failures_[Failure::gave_up];
    gave_up_after_ns_ = machine_.outage_ns(now_ns);
  } else if (was_open && !machine_.is_open() && !is_away(why)) {
    ++failures_[Failure::bus_reset];
  }
  if (!machine_.is_open() && (is_away(why) || machine_.state() == MachineState::given_up)) close_transport();
}

/// `timeout` while the device, if it is still there, has yet to tell how many frames there were.
hal::Error DeviceSource::given_up(std::int64_t deadline_ns) {
  constexpr int most_farewells = 8;  // that are cut short
  if (!end_stream(lost_as_, deadline_ns) && ++farewells_ < most_farewells) return {hal::ErrorCode::timeout, {}, {}};
  if (extent_.is_open()) close_stream(extent_.close(clock_.now_ns()), lost_as_);
  machine_.close();
  close_transport();
  std::string why = last_error_.sentence.empty() ? "it does not answer" : last_error_.sentence;
  return {hal::ErrorCode::disconnected, serial_,
          "frames stopped, and recovery was given up after " + in_seconds(gave_up_after_ns_) + ": " + why +
              "; plug the eye in and start again"};
}

}  // namespace compueye::device
