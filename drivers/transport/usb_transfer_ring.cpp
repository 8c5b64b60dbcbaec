#include "drivers/transport/usb_transfer_ring.hpp"

#include <libusb-1.0/libusb.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <optional>
#include <system_error>
#include <utility>

#include "drivers/transport/usb_error.hpp"

namespace compueye::transport {
namespace {

using Clock = std::chrono::steady_clock;

// How long the thread sleeps in libusb when nobody wakes it, and how long a cancelled transfer may take to come back
// before closing the device file takes it from the kernel.
constexpr long most_event_wait_us = 250'000;
constexpr auto most_drain = std::chrono::seconds(3);
constexpr auto after_event_error = std::chrono::milliseconds(1);

Clock::time_point time_of(std::int64_t deadline_ns) {
  return Clock::time_point(std::chrono::duration_cast<Clock::duration>(std::chrono::nanoseconds(deadline_ns)));
}

}  // namespace

UsbTransferRing::UsbTransferRing(Settings settings) : settings_(std::move(settings)) {}

hal::Result<std::unique_ptr<UsbTransferRing>> UsbTransferRing::start(Settings settings) {
  std::unique_ptr<UsbTransferRing> ring(new UsbTransferRing(std::move(settings)));
  int code = ring->allocate() ? LIBUSB_SUCCESS : LIBUSB_ERROR_NO_MEM;
  if (code == LIBUSB_SUCCESS) code = ring->submit_free();
  if (code != LIBUSB_SUCCESS) return tl::unexpected(usb_error(code, ring->settings_.place, "starting the transfers"));
  try {
    ring->thread_ = std::thread([each = ring.get()] { each->run(); });
  } catch (const std::system_error& error) {
    return hal::fail(hal::ErrorCode::no_space, ring->settings_.place,
                     std::string("no thread to read the eye with: ") + error.what() + "; end other programs");
  }
  return ring;
}

UsbTransferRing::~UsbTransferRing() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) {
    libusb_interrupt_event_handler(settings_.context);
    thread_.join();
  } else {
    drain();
  }
  // What the kernel still holds, after most_drain, stays allocated: libusb_close() takes it off its lists.
  if (in_flight_ > 0) return;
  for (Slot& each : slots_) libusb_free_transfer(each.transfer);
}

bool UsbTransferRing::allocate() {
  const auto count = static_cast<std::size_t>(settings_.transfers);
  memory_ = std::make_unique<std::byte[]>(count * settings_.transfer_bytes);
  slots_.resize(count);
  for (std::size_t k = 0; k < count; ++k) {
    slots_[k].ring = this;
    slots_[k].transfer = libusb_alloc_transfer(0);
    if (slots_[k].transfer == nullptr) return false;
    libusb_fill_bulk_transfer(slots_[k].transfer, settings_.handle, settings_.endpoint,
                              reinterpret_cast<unsigned char*>(memory_.get() + k * settings_.transfer_bytes),
                              static_cast<int>(settings_.transfer_bytes), &UsbTransferRing::on_completion, &slots_[k],
                              0);
  }
  return true;
}

void UsbTransferRing::run() {
  for (;;) {
    bool back = false, restarting = false, submitting = false;
    {
      const std::lock_guard lock(mutex_);
      if (stopping_) break;
      restarting = restart_ == Restart::wanted;
      back = in_flight_ == 0;
      submitting = !restarting && !gone_ && !halted_;
    }
    if (restarting) {
      if (back) {
        begin_anew();
        continue;
      }
      cancel_all();
    } else if (submitting && submit_free() != LIBUSB_SUCCESS) {
      changed_.notify_all();
    }
    handle_events();
  }
  drain();
}

void UsbTransferRing::handle_events() const {
  timeval wait{0, most_event_wait_us};
  if (libusb_handle_events_timeout_completed(settings_.context, &wait, nullptr) != LIBUSB_SUCCESS) {
    std::this_thread::sleep_for(after_event_error);
  }
}

/// Submits every buffer that has been read; only the thread calls it, and start() before there is one.
int UsbTransferRing::submit_free() {
  for (;;) {
    Slot* next = nullptr;
    {
      const std::lock_guard lock(mutex_);
      if (submitted_ - consumed_ == slots_.size() || gone_ || halted_) return LIBUSB_SUCCESS;
      next = &slot(submitted_++);
      next->done = false;
      ++in_flight_;  // before the submission: the completion may come first
      counters_.most_in_flight = std::max(counters_.most_in_flight, in_flight_);
    }
    const int code = libusb_submit_transfer(next->transfer);
    const std::lock_guard lock(mutex_);
    submit_error_ = code;
    if (code == LIBUSB_SUCCESS) continue;
    --submitted_;
    --in_flight_;
    gone_ = gone_ || code == LIBUSB_ERROR_NO_DEVICE;
    return code;
  }
}

void UsbTransferRing::on_completion(libusb_transfer* transfer) noexcept {
  Slot& slot = *static_cast<Slot*>(transfer->user_data);
  slot.ring->completed(slot);
}

void UsbTransferRing::completed(Slot& done) noexcept {
  {
    const std::lock_guard lock(mutex_);
    done.done = true;
    done.status = done.transfer->status;
    done.bytes = static_cast<std::size_t>(std::max(done.transfer->actual_length, 0));
    done.read = 0;
    --in_flight_;
    while (completed_ < submitted_ && slot(completed_).done) ++completed_;
    switch (done.status) {
      case LIBUSB_TRANSFER_COMPLETED:
        ++counters_.transfers;
        counters_.bytes += done.bytes;
        break;
      case LIBUSB_TRANSFER_STALL:
        halted_ = true;
        ++counters_.stalls;
        break;
      case LIBUSB_TRANSFER_NO_DEVICE:
        gone_ = true;
        break;
      case LIBUSB_TRANSFER_CANCELLED:
        break;
      default:
        ++counters_.errors;
    }
  }
  changed_.notify_all();
}

void UsbTransferRing::cancel_all() {
  // A transfer that is not in flight is refused with NOT_FOUND, which is no harm.
  for (Slot& each : slots_) libusb_cancel_transfer(each.transfer);
}

void UsbTransferRing::drain() {
  const auto give_up = Clock::now() + most_drain;
  cancel_all();
  for (;;) {
    {
      const std::lock_guard lock(mutex_);
      if (in_flight_ == 0) return;
    }
    if (Clock::now() > give_up) return;
    handle_events();
  }
}

void UsbTransferRing::begin_anew() {
  int code = libusb_clear_halt(settings_.handle, settings_.endpoint);
  {
    const std::lock_guard lock(mutex_);
    submitted_ = completed_ = consumed_ = 0;
    halted_ = false;
    gone_ = gone_ || code == LIBUSB_ERROR_NO_DEVICE;
    ++counters_.restarts;
  }
  if (code == LIBUSB_SUCCESS) code = submit_free();
  {
    const std::lock_guard lock(mutex_);
    restart_ = Restart::done;
    restart_error_ = code;
  }
  changed_.notify_all();
}

hal::Result<void> UsbTransferRing::restart(std::int64_t deadline_ns) {
  std::unique_lock lock(mutex_);
  restart_ = Restart::wanted;
  lock.unlock();
  libusb_interrupt_event_handler(settings_.context);
  lock.lock();
  if (!changed_.wait_until(lock, time_of(deadline_ns), [&] { return restart_ == Restart::done; })) {
    return hal::timed_out();
  }
  if (restart_error_ == LIBUSB_SUCCESS) return {};
  return tl::unexpected(usb_error(restart_error_, settings_.place, "clearing the stream's endpoint"));
}

hal::Error UsbTransferRing::error_of(int status) const {
  switch (status) {
    case LIBUSB_TRANSFER_NO_DEVICE:
      return usb_error(LIBUSB_ERROR_NO_DEVICE, settings_.place, "reading the stream");
    case LIBUSB_TRANSFER_STALL:
      return {hal::ErrorCode::io, settings_.place, "the eye stalled the stream; reset its pipes or open it again"};
    case LIBUSB_TRANSFER_OVERFLOW:
      return usb_error(LIBUSB_ERROR_OVERFLOW, settings_.place, "reading the stream");
    default:
      return {hal::ErrorCode::io, settings_.place, "the cable damaged a transfer; check it if this goes on"};
  }
}

/// Copies what has come, in order, up to the first transfer that ended in an error. The mutex is held.
std::size_t UsbTransferRing::copy_out(std::span<std::byte> into) noexcept {
  std::size_t copied = 0;
  while (consumed_ < completed_ && copied < into.size()) {
    Slot& next = slot(consumed_);
    const std::size_t part = std::min(next.bytes - next.read, into.size() - copied);
    if (part > 0) std::memcpy(into.data() + copied, next.transfer->buffer + next.read, part);
    next.read += part;
    copied += part;
    if (next.read < next.bytes) break;
    if (next.status != LIBUSB_TRANSFER_COMPLETED && next.status != LIBUSB_TRANSFER_CANCELLED) break;
    ++consumed_;
  }
  return copied;
}

/// In batches: each waking of the thread costs a system call, and it also submits whenever a transfer completes.
bool UsbTransferRing::wants_submission() const noexcept {
  const std::uint64_t free = slots_.size() - (submitted_ - consumed_);
  return free * 4 >= slots_.size() && !halted_ && !gone_;
}

hal::Result<std::size_t> UsbTransferRing::read(std::span<std::byte> into, std::int64_t deadline_ns) {
  if (into.empty()) return std::size_t{0};
  std::unique_lock lock(mutex_);
  for (;;) {
    const std::size_t copied = copy_out(into);
    std::optional<hal::Error> error;
    if (copied == 0 && consumed_ < completed_) {
      error = error_of(slot(consumed_).status);
      ++consumed_;
    } else if (copied == 0 && (gone_ || halted_)) {
      error = error_of(gone_ ? LIBUSB_TRANSFER_NO_DEVICE : LIBUSB_TRANSFER_STALL);
    } else if (copied == 0 && submit_error_ != LIBUSB_SUCCESS && in_flight_ == 0) {
      error = usb_error(submit_error_, settings_.place, "reading the stream");
      error->code = hal::ErrorCode::io;
    }
    const bool wake = wants_submission();
    if (copied > 0 || error || wake) {
      lock.unlock();
      if (wake) libusb_interrupt_event_handler(settings_.context);
      if (copied > 0) return copied;
      if (error) return tl::unexpected(std::move(*error));
      lock.lock();
      if (consumed_ < completed_) continue;
    }
    if (changed_.wait_until(lock, time_of(deadline_ns)) == std::cv_status::timeout && consumed_ == completed_ &&
        !gone_ && !halted_) {
      return hal::timed_out();
    }
  }
}

UsbStreamCounters UsbTransferRing::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

}  // namespace compueye::transport
