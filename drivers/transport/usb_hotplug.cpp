#include "drivers/transport/usb_hotplug.hpp"

#include <libusb-1.0/libusb.h>

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "drivers/transport/usb_error.hpp"
#include "hal/clock.hpp"

namespace compueye::transport {
namespace {

constexpr std::int64_t ns_per_s = 1'000'000'000, ns_per_us = 1000;

/// Looks at the bus through a new context each time: one that lives on would trust in events.
class PollingHotplug final : public UsbHotplug {
 public:
  explicit PollingHotplug(Settings settings) : settings_(settings), seen_(look()) {}

  bool wait(std::int64_t deadline_ns) override {
    for (;;) {
      if (auto now = look(); now != seen_) {
        seen_ = std::move(now);
        return true;
      }
      const std::int64_t now_ns = clock_.now_ns();
      if (now_ns >= deadline_ns) return false;
      clock_.sleep_until_ns(std::min(now_ns + settings_.poll_ns, deadline_ns));
    }
  }
  [[nodiscard]] HotplugMethod method() const noexcept override { return HotplugMethod::polling; }

 private:
  /// Bus numbers and addresses of the eyes; a device that is plugged in again has another address.
  [[nodiscard]] std::vector<unsigned> look() const {
    std::vector<unsigned> eyes;
    libusb_context* context = nullptr;
    if (libusb_init(&context) != LIBUSB_SUCCESS) return eyes;
    libusb_device** devices = nullptr;
    const auto count = libusb_get_device_list(context, &devices);
    for (std::int64_t k = 0; k < count; ++k) {
      libusb_device_descriptor descriptor{};
      if (libusb_get_device_descriptor(devices[k], &descriptor) != LIBUSB_SUCCESS) continue;
      if (descriptor.idVendor != settings_.identity.vendor || descriptor.idProduct != settings_.identity.product) {
        continue;
      }
      eyes.push_back(libusb_get_bus_number(devices[k]) * 256U + libusb_get_device_address(devices[k]));
    }
    if (count >= 0) libusb_free_device_list(devices, 1);
    libusb_exit(context);
    std::sort(eyes.begin(), eyes.end());
    return eyes;
  }

  Settings settings_;
  hal::MonotonicClock clock_;
  std::vector<unsigned> seen_;
};

class EventHotplug final : public UsbHotplug {
 public:
  EventHotplug() = default;
  EventHotplug(const EventHotplug&) = delete;
  EventHotplug& operator=(const EventHotplug&) = delete;
  ~EventHotplug() override {
    if (context_ == nullptr) return;
    if (registered_) libusb_hotplug_deregister_callback(context_, callback_);
    libusb_exit(context_);
  }

  int begin(const Settings& settings) {
    if (const int code = libusb_init(&context_); code != LIBUSB_SUCCESS) {
      context_ = nullptr;
      return code;
    }
    const int code = libusb_hotplug_register_callback(
        context_, LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED | LIBUSB_HOTPLUG_EVENT_DEVICE_LEFT, LIBUSB_HOTPLUG_NO_FLAGS,
        settings.identity.vendor, settings.identity.product, LIBUSB_HOTPLUG_MATCH_ANY, &EventHotplug::on_event, this,
        &callback_);
    registered_ = code == LIBUSB_SUCCESS;
    return code;
  }

  bool wait(std::int64_t deadline_ns) override {
    while (!changed_) {
      const std::int64_t left_ns = deadline_ns - clock_.now_ns();
      if (left_ns <= 0) break;
      const std::int64_t wait_ns = std::min(left_ns, ns_per_s);
      timeval wait{static_cast<time_t>(wait_ns / ns_per_s), static_cast<suseconds_t>(wait_ns % ns_per_s / ns_per_us)};
      if (libusb_handle_events_timeout_completed(context_, &wait, nullptr) != LIBUSB_SUCCESS) {
        clock_.sleep_until_ns(clock_.now_ns() + wait_ns);
      }
    }
    return std::exchange(changed_, false);
  }
  [[nodiscard]] HotplugMethod method() const noexcept override { return HotplugMethod::event; }

 private:
  static int on_event(libusb_context*, libusb_device*, libusb_hotplug_event, void* self) noexcept {
    static_cast<EventHotplug*>(self)->changed_ = true;  // in wait(): events are handled nowhere else
    return 0;
  }

  libusb_context* context_ = nullptr;
  libusb_hotplug_callback_handle callback_ = 0;
  bool registered_ = false;
  bool changed_ = false;
  hal::MonotonicClock clock_;
};

}  // namespace

hal::Result<std::unique_ptr<UsbHotplug>> UsbHotplug::start(Settings settings) {
  const bool has_events = libusb_has_capability(LIBUSB_CAP_HAS_HOTPLUG) != 0;
  if (settings.method == HotplugMethod::event && !has_events) {
    return hal::fail(hal::ErrorCode::unsupported, "usb", "this libusb has no hotplug events; use polling");
  }
  if (settings.method == HotplugMethod::polling || !has_events) return std::make_unique<PollingHotplug>(settings);
  auto events = std::make_unique<EventHotplug>();
  if (const int code = events->begin(settings); code != LIBUSB_SUCCESS) {
    return tl::unexpected(usb_error(code, "usb", "waiting for eyes to come and go"));
  }
  return events;
}

}  // namespace compueye::transport
