#include "tests/hil/level3/usbip_device.hpp"

#include <linux/usb/ch9.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <optional>

namespace compueye::hil {
namespace {

using Outcome = UsbDeviceModel::Outcome;
using Transfer = UsbDeviceModel::Transfer;

constexpr int most_at_a_time = 64;  // requests that are taken before any is answered

bool receive(int socket, std::span<std::byte> into) {
  while (!into.empty()) {
    const ssize_t got = ::recv(socket, into.data(), into.size(), MSG_WAITALL);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    into = into.subspan(static_cast<std::size_t>(got));
  }
  return true;
}

bool send(int socket, std::span<const std::byte> from) {
  while (!from.empty()) {
    const ssize_t sent = ::send(socket, from.data(), from.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    from = from.subspan(static_cast<std::size_t>(sent));
  }
  return true;
}

bool readable(int socket, int patience_ms) {
  pollfd file{socket, POLLIN, 0};
  return ::poll(&file, 1, patience_ms) > 0;
}

std::uint16_t little_u16(const std::byte* at) {
  return static_cast<std::uint16_t>(std::to_integer<unsigned>(at[0]) | std::to_integer<unsigned>(at[1]) << 8U);
}

/// What chapter 9 asks of any device, and a device of one configuration and setting need do nothing for.
bool granted(std::uint8_t request) {
  return request == USB_REQ_CLEAR_FEATURE || request == USB_REQ_SET_FEATURE || request == USB_REQ_SET_INTERFACE;
}

}  // namespace

bool UsbipDevice::serve(int patience_ms) {
  for (int k = 0; k < most_at_a_time && readable(socket_, k == 0 ? patience_ms : 0); ++k) {
    if (!take()) return false;
  }
  return answer_waiting();
}

bool UsbipDevice::take() {
  UsbipHeader header{};
  if (!receive(socket_, header)) return false;
  const auto request = parse_usbip(header);
  if (!request) return false;
  if (request->command == UsbipCommand::unlink) return unlink(*request);
  Waiting waiting{*request, std::vector<std::byte>(request->length)};
  if (!request->in && !receive(socket_, waiting.data)) return false;
  waiting_.push_back(std::move(waiting));
  return true;
}

bool UsbipDevice::unlink(const UsbipRequest& request) {
  const auto found = std::find_if(waiting_.begin(), waiting_.end(),
                                  [&](const Waiting& each) { return each.request.number == request.unlinked; });
  const bool waits = found != waiting_.end();
  if (waits) waiting_.erase(found);
  return send(socket_, usbip_unlinked(request, waits ? -ECONNRESET : 0));
}

/// In order on either endpoint; one request that the device does not answer holds up those behind it on the same one.
bool UsbipDevice::answer_waiting() {
  bool stream_waits = false, control_waits = false;
  for (auto each = waiting_.begin(); each != waiting_.end();) {
    bool& waits = each->request.endpoint == 0 ? control_waits : stream_waits;
    if (!waits) {
      const Transfer transfer = each->request.endpoint == 0 ? control(*each) : model_.read(each->data);
      if (transfer.outcome == Outcome::gone) return false;
      if (transfer.outcome != Outcome::nothing) {
        if (!answer(*each, transfer)) return false;
        // A halted endpoint stays where it is; the transfers behind it wait.
        waits = transfer.outcome == Outcome::stalled && each->request.endpoint != 0;
        each = waiting_.erase(each);
        continue;
      }
      waits = true;
    }
    ++each;
  }
  return true;
}

bool UsbipDevice::answer(const Waiting& each, Transfer transfer) {
  const int status = transfer.outcome == Outcome::stalled ? -EPIPE : 0;
  // A request towards the device moved all of its data or was refused.
  const std::size_t bytes = status != 0 ? 0 : each.request.in ? transfer.bytes : each.data.size();
  if (!send(socket_, usbip_submitted(each.request, status, bytes))) return false;
  return !each.request.in || send(socket_, std::span(each.data).first(bytes));
}

Transfer UsbipDevice::control(Waiting& each) {
  const auto& setup = each.request.setup;
  const UsbDeviceModel::Setup asked{std::to_integer<std::uint8_t>(setup[0]), std::to_integer<std::uint8_t>(setup[1]),
                                    little_u16(setup.data() + 2), little_u16(setup.data() + 4)};
  const std::span<std::byte> data = each.data;
  const bool to_device = (asked.type & USB_RECIP_MASK) == USB_RECIP_DEVICE;
  if ((asked.type & USB_TYPE_MASK) != USB_TYPE_STANDARD) return model_.control(asked, data);
  if (asked.request == USB_REQ_GET_DESCRIPTOR && to_device && asked.value >> 8U != USB_DT_STRING) {
    return descriptor(asked.value >> 8U, data);
  }
  if (asked.request == USB_REQ_SET_CONFIGURATION) {
    model_.reset();  // vhci keeps bus resets to itself; behind each the host configures the device again
    return {Outcome::done, 0};
  }
  if (asked.request == USB_REQ_GET_STATUS) {
    std::fill(data.begin(), data.end(), std::byte{0});
    return {Outcome::done, std::min<std::size_t>(data.size(), 2)};
  }
  if (granted(asked.request)) return {Outcome::done, 0};
  return model_.control(asked, data);
}

Transfer UsbipDevice::descriptor(unsigned kind, std::span<std::byte> data) const {
  const std::size_t device_bytes = descriptors_.empty() ? 0 : descriptors_[0];
  std::span<const std::uint8_t> found;
  if (kind == USB_DT_DEVICE) found = std::span(descriptors_).first(device_bytes);
  if (kind == USB_DT_CONFIG) found = std::span(descriptors_).subspan(device_bytes);
  if (found.empty()) return {Outcome::stalled, 0};
  const std::size_t bytes = std::min(found.size(), data.size());
  std::transform(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(bytes), data.begin(),
                 [](std::uint8_t value) { return std::byte{value}; });
  return {Outcome::done, bytes};
}

}  // namespace compueye::hil
