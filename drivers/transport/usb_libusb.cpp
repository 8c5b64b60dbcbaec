#include "drivers/transport/usb_libusb.hpp"

#include <libusb-1.0/libusb.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "drivers/protocol/requests.hpp"
#include "drivers/transport/usb_control.hpp"
#include "drivers/transport/usb_error.hpp"
#include "hal/clock.hpp"
#include "hal/try.hpp"

namespace compueye::transport {
namespace {

struct StreamEndpoint {
  int interface_number = 0;
  std::uint8_t address = 0;
  std::size_t max_packet = 0;
};

std::optional<StreamEndpoint> stream_endpoint_of(const libusb_interface_descriptor& setting) {
  if (setting.bInterfaceClass != LIBUSB_CLASS_VENDOR_SPEC) return std::nullopt;
  for (int k = 0; k < setting.bNumEndpoints; ++k) {
    const libusb_endpoint_descriptor& each = setting.endpoint[k];
    const bool in = (each.bEndpointAddress & LIBUSB_ENDPOINT_DIR_MASK) == LIBUSB_ENDPOINT_IN;
    const bool bulk = (each.bmAttributes & LIBUSB_TRANSFER_TYPE_MASK) == LIBUSB_TRANSFER_TYPE_BULK;
    const std::size_t max_packet = each.wMaxPacketSize & 0x7FFU;
    if (in && bulk && max_packet > 0) {
      return StreamEndpoint{setting.bInterfaceNumber, each.bEndpointAddress, max_packet};
    }
  }
  return std::nullopt;
}

std::optional<StreamEndpoint> find_stream_endpoint(libusb_device* device) {
  libusb_config_descriptor* raw = nullptr;
  if (libusb_get_active_config_descriptor(device, &raw) != LIBUSB_SUCCESS) return std::nullopt;
  const std::unique_ptr<libusb_config_descriptor, void (*)(libusb_config_descriptor*)> config(
      raw, libusb_free_config_descriptor);
  for (int k = 0; k < config->bNumInterfaces; ++k) {
    const libusb_interface& each = config->interface[k];
    if (each.num_altsetting < 1) continue;
    if (const auto found = stream_endpoint_of(each.altsetting[0])) return found;
  }
  return std::nullopt;
}

hal::Result<void> check(const UsbSettings& settings, std::size_t transfer_bytes) {
  const auto refuse = [&](std::string sentence) {
    return hal::fail(hal::ErrorCode::out_of_range, "usb", std::move(sentence));
  };
  if (settings.transfers < UsbSettings::least_transfers || settings.transfers > UsbSettings::most_transfers) {
    return refuse("transfers is " + std::to_string(settings.transfers) + ", expected " +
                  std::to_string(UsbSettings::least_transfers) + " to " + std::to_string(UsbSettings::most_transfers));
  }
  if (settings.most_in_flight_bytes >= UsbSettings::in_flight_limit) {
    return refuse("most_in_flight_bytes is " + std::to_string(settings.most_in_flight_bytes) +
                  ", expected less than the 16 MiB that Linux gives all programs");
  }
  if (transfer_bytes == 0 ||
      transfer_bytes > settings.most_in_flight_bytes / static_cast<std::size_t>(settings.transfers)) {
    return refuse("transfer_bytes is " + std::to_string(transfer_bytes) + ", expected 1 to " +
                  std::to_string(settings.most_in_flight_bytes / static_cast<std::size_t>(settings.transfers)) +
                  ", so that " + std::to_string(settings.transfers) + " of them stay within most_in_flight_bytes");
  }
  return {};
}

constexpr std::int64_t ns_per_ms = 1'000'000;
// Beside the eye's time to answer RESET_PIPES: the kernel gives back what is in flight one by one, which takes a slow
// processor 100 ms and more (level 3 of the test ladder).
constexpr std::int64_t restart_ns = 400 * ns_per_ms;

}  // namespace

/// All that an open device holds, given back in the opposite order.
struct UsbTransport::Connection {
  Connection() = default;
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  ~Connection() {
    ring.reset();
    control.reset();
    if (handle != nullptr) {
      if (claimed >= 0) libusb_release_interface(handle, claimed);
      libusb_close(handle);
    }
    if (context != nullptr) libusb_exit(context);
  }

  libusb_context* context = nullptr;
  libusb_device_handle* handle = nullptr;
  int claimed = -1;
  std::unique_ptr<UsbControl> control;
  std::unique_ptr<UsbTransferRing> ring;
};

const Cable usb_cable{protocol::usb_bus, [] { return list_usb_eyes(); },
                      [](const std::string& serial) -> std::unique_ptr<hal::ByteTransport> {
                        UsbSettings settings;
                        settings.serial = serial;
                        return std::make_unique<UsbTransport>(std::move(settings));
                      }};

UsbTransport::UsbTransport(UsbSettings settings) : settings_(std::move(settings)) {
  description_.bus = "usb";
  description_.serial = settings_.serial;
}

UsbTransport::~UsbTransport() {
  close();
}

void UsbTransport::close() noexcept {
  connection_.reset();
}

hal::Result<void> UsbTransport::open() {
  close();
  TRY(check(settings_, settings_.transfer_bytes));
  auto connection = std::make_unique<Connection>();
  TRY(connect(*connection));
  connection_ = std::move(connection);
  return {};
}

hal::Result<void> UsbTransport::connect(Connection& connection) {
  if (const int code = libusb_init(&connection.context); code != LIBUSB_SUCCESS) {
    connection.context = nullptr;
    return tl::unexpected(usb_error(code, "usb", "starting libusb"));
  }
  const OpenedUsbEye opened = TRY(open_usb_eye(connection.context, settings_.identity, settings_.serial));
  connection.handle = opened.handle;
  const std::string place = opened.eye.bus + " (" + opened.eye.serial + ")";

  const auto endpoint = find_stream_endpoint(libusb_get_device(connection.handle));
  if (!endpoint) {
    return hal::fail(hal::ErrorCode::unsupported, place,
                     "the device has no vendor interface with a bulk-in endpoint; is its firmware an eye's?");
  }
  if (const int code = libusb_claim_interface(connection.handle, endpoint->interface_number); code != LIBUSB_SUCCESS) {
    return tl::unexpected(usb_error(code, place, "claiming the stream"));
  }
  connection.claimed = endpoint->interface_number;
  // Only now that it is ours: a reset would end another program's stream. libusb claims it again.
  if (const int code = libusb_reset_device(connection.handle); code != LIBUSB_SUCCESS) {
    return tl::unexpected(usb_error(code, place, "resetting the eye"));
  }

  const std::size_t packets = (settings_.transfer_bytes + endpoint->max_packet - 1) / endpoint->max_packet;
  const std::size_t transfer_bytes = packets * endpoint->max_packet;
  TRY(check(settings_, transfer_bytes));
  connection.control = TRY(UsbControl::create(connection.handle));
  connection.ring = TRY(UsbTransferRing::start(
      {connection.context, connection.handle, endpoint->address, settings_.transfers, transfer_bytes, place}));
  description_ = {opened.eye.bus, opened.eye.serial, endpoint->max_packet};
  return {};
}

hal::Error UsbTransport::not_open() const {
  return {hal::ErrorCode::usage, description_.bus, "the transport is not open; call open() first"};
}

hal::Result<std::size_t> UsbTransport::read(std::span<std::byte> into, std::int64_t deadline_ns) {
  if (!connection_) return tl::unexpected(not_open());
  return connection_->ring->read(into, deadline_ns);
}

hal::Result<std::size_t> UsbTransport::control(std::uint8_t request, std::span<const std::byte> payload,
                                               std::span<std::byte> reply, std::int64_t deadline_ns) {
  if (!connection_) return tl::unexpected(not_open());
  const bool in = !reply.empty();
  if ((in && payload.size() > 4) || payload.size() > protocol::most_control_bytes ||
      reply.size() > protocol::most_control_bytes) {
    return hal::fail(hal::ErrorCode::usage, description_.serial,
                     "a request carries 4 bytes with a reply, 4096 without, and a reply 4096 at most");
  }
  const std::int64_t left_ns = deadline_ns - hal::MonotonicClock().now_ns();
  if (left_ns <= 0) return hal::timed_out();
  const auto timeout_ms = static_cast<unsigned>(std::clamp<std::int64_t>(left_ns / ns_per_ms, 1, 60'000));

  const auto word = [&](std::size_t at) {
    const auto byte = [&](std::size_t k) { return k < payload.size() ? std::to_integer<unsigned>(payload[k]) : 0U; };
    return static_cast<std::uint16_t>(in ? byte(at) | byte(at + 1) << 8U : 0U);
  };
  const auto type = static_cast<std::uint8_t>(static_cast<unsigned>(LIBUSB_REQUEST_TYPE_VENDOR) |
                                              static_cast<unsigned>(in ? LIBUSB_ENDPOINT_IN : LIBUSB_ENDPOINT_OUT));
  const int bytes = connection_->control->transfer({type, request, word(0), word(2)},
                                                   in ? std::span<const std::byte>() : payload, reply, timeout_ms);
  if (bytes == LIBUSB_ERROR_TIMEOUT) return hal::timed_out();
  if (bytes < 0) {
    return tl::unexpected(usb_error(bytes, description_.serial, "request " + std::to_string(request)));
  }
  if (request == protocol::number(protocol::Request::reset_pipes)) {
    TRY(connection_->ring->restart(std::max(deadline_ns, hal::MonotonicClock().now_ns() + restart_ns)));
  }
  return in ? static_cast<std::size_t>(bytes) : std::size_t{0};
}

UsbStreamCounters UsbTransport::counters() const {
  return connection_ ? connection_->ring->counters() : UsbStreamCounters{};
}

}  // namespace compueye::transport
