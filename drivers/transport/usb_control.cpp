#include "drivers/transport/usb_control.hpp"

#include <libusb-1.0/libusb.h>

#include <algorithm>
#include <cstring>

#include "drivers/protocol/requests.hpp"
#include "drivers/transport/usb_error.hpp"

namespace compueye::transport {
namespace {

int code_of(int status) {
  switch (status) {
    case LIBUSB_TRANSFER_COMPLETED:
      return LIBUSB_SUCCESS;
    case LIBUSB_TRANSFER_TIMED_OUT:
      return LIBUSB_ERROR_TIMEOUT;
    case LIBUSB_TRANSFER_STALL:
      return LIBUSB_ERROR_PIPE;
    case LIBUSB_TRANSFER_NO_DEVICE:
      return LIBUSB_ERROR_NO_DEVICE;
    case LIBUSB_TRANSFER_OVERFLOW:
      return LIBUSB_ERROR_OVERFLOW;
    default:
      return LIBUSB_ERROR_IO;
  }
}

}  // namespace

hal::Result<std::unique_ptr<UsbControl>> UsbControl::create(libusb_device_handle* handle) {
  std::unique_ptr<UsbControl> control(new UsbControl);
  control->handle_ = handle;
  control->buffer_.resize(LIBUSB_CONTROL_SETUP_SIZE + protocol::most_control_bytes);
  control->transfer_ = libusb_alloc_transfer(0);
  if (control->transfer_ == nullptr) {
    return tl::unexpected(usb_error(LIBUSB_ERROR_NO_MEM, "usb", "making the control transfer"));
  }
  return control;
}

UsbControl::~UsbControl() {
  libusb_free_transfer(transfer_);
}

void UsbControl::on_completion(libusb_transfer* transfer) noexcept {
  UsbControl& control = *static_cast<UsbControl*>(transfer->user_data);
  const std::lock_guard lock(control.mutex_);
  control.under_way_ = false;
  control.finished_.notify_all();
}

int UsbControl::transfer(const Request& request, std::span<const std::byte> out, std::span<std::byte> into,
                         unsigned timeout_ms) {
  const std::lock_guard alone(one_at_a_time_);
  const std::size_t bytes = std::max(out.size(), into.size());
  if (bytes > protocol::most_control_bytes) return LIBUSB_ERROR_INVALID_PARAM;
  libusb_fill_control_setup(buffer_.data(), request.type, request.number, request.value, request.index,
                            static_cast<std::uint16_t>(bytes));
  if (!out.empty()) std::memcpy(buffer_.data() + LIBUSB_CONTROL_SETUP_SIZE, out.data(), out.size());
  libusb_fill_control_transfer(transfer_, handle_, buffer_.data(), &UsbControl::on_completion, this, timeout_ms);
  under_way_ = true;
  if (const int code = libusb_submit_transfer(transfer_); code != LIBUSB_SUCCESS) return code;
  std::unique_lock lock(mutex_);
  // libusb ends it in time: by the timeout at the latest, and when the device goes.
  finished_.wait(lock, [&] { return !under_way_; });
  if (const int code = code_of(transfer_->status); code != LIBUSB_SUCCESS) return code;
  const auto count = static_cast<std::size_t>(std::max(transfer_->actual_length, 0));
  const std::size_t received = std::min(count, into.size());
  if (received > 0) std::memcpy(into.data(), buffer_.data() + LIBUSB_CONTROL_SETUP_SIZE, received);
  return static_cast<int>(into.empty() ? count : received);
}

}  // namespace compueye::transport
