#include "drivers/transport/hid_hidapi.hpp"

#include <hidapi/hidapi.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <limits>
#include <optional>
#include <utility>

#include "drivers/protocol/hid_control.hpp"
#include "drivers/protocol/hid_report.hpp"
#include "hal/clock.hpp"

namespace compueye::transport {
namespace {

struct CloseDevice {
  void operator()(hid_device* device) const noexcept { hid_close(device); }
};
using Device = std::unique_ptr<hid_device, CloseDevice>;

/// Tells a device file from another of the same name that came later.
struct FileIdentity {
  dev_t device = 0;
  ino_t node = 0;
  friend bool operator==(const FileIdentity&, const FileIdentity&) = default;
};
std::optional<FileIdentity> identity_of(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) return std::nullopt;
  return FileIdentity{status.st_dev, status.st_ino};
}

constexpr std::int64_t ns_per_ms = 1'000'000;

/// Rounded up, so that a deadline is never missed by early waking.
int milliseconds_until(std::int64_t deadline_ns) {
  const std::int64_t left_ns = deadline_ns - hal::MonotonicClock().now_ns();
  if (left_ns <= 0) return 0;
  return static_cast<int>(std::min<std::int64_t>((left_ns - 1) / ns_per_ms + 1, std::numeric_limits<int>::max()));
}

}  // namespace

struct HidTransport::Connection {
  std::string path;
  std::optional<FileIdentity> file;
  Device input, requests;
};

HidTransport::HidTransport(HidSettings settings) : settings_(std::move(settings)) {
  description_ = {"hid", settings_.serial, protocol::hid_report_bytes};
}

HidTransport::~HidTransport() {
  close();
}

void HidTransport::close() noexcept {
  connection_.reset();
}

hal::Result<void> HidTransport::open() {
  close();
  auto eye = find_hid_eye(settings_.identity, settings_.serial);
  if (!eye) return tl::unexpected(std::move(eye.error()));
  auto connection = std::make_unique<Connection>();
  connection->path = eye->path;
  connection->input.reset(hid_open_path(eye->path.c_str()));
  connection->requests.reset(hid_open_path(eye->path.c_str()));
  connection->file = identity_of(eye->path);
  if (!connection->input || !connection->requests || !connection->file) {
    return hal::fail(
        hal::ErrorCode::io, eye->path,
        "the device file does not open; plug the eye in again, and install boards/generic-hid/70-compueye.rules");
  }
  description_.bus = eye->bus;
  description_.serial = eye->serial;
  connection_ = std::move(connection);
  return {};
}

hal::Error HidTransport::not_open() const {
  return {hal::ErrorCode::usage, description_.bus, "the transport is not open; call open() first"};
}

/// hidapi has only words for an error; the error number of the system call that failed is still there.
hal::Error HidTransport::failure(int error, const char* doing) const {
  const std::string place = description_.bus + " (" + description_.serial + ")";
  if (error == ENODEV || identity_of(connection_->path) != connection_->file) {
    return {hal::ErrorCode::disconnected, place, std::string(doing) + ": the eye was unplugged; plug it in again"};
  }
  switch (error) {
    case ETIMEDOUT:
      return {hal::ErrorCode::timeout, {}, {}};
    case EPIPE:
      return {hal::ErrorCode::io, place, std::string(doing) + ": the eye refused it (stall); STATUS says why"};
    default:
      return {
          hal::ErrorCode::io, place,
          std::string(doing) + " failed (error " + std::to_string(error) + "); check the cable and open the eye again"};
  }
}

hal::Result<std::size_t> HidTransport::read(std::span<std::byte> into, std::int64_t deadline_ns) {
  if (!connection_) return tl::unexpected(not_open());
  if (into.size() < protocol::hid_report_bytes) {
    return hal::fail(hal::ErrorCode::usage, description_.bus, "a report needs room for 64 bytes");
  }
  for (;;) {
    const int wait_ms = milliseconds_until(deadline_ns);
    errno = 0;
    const int bytes = hid_read_timeout(connection_->input.get(), reinterpret_cast<unsigned char*>(into.data()),
                                       protocol::hid_report_bytes, wait_ms);
    if (bytes > 0) return static_cast<std::size_t>(bytes);
    // Without an error number it was poll() that saw the device hang up.
    if (bytes < 0 && errno != EINTR) {
      return tl::unexpected(failure(errno == 0 ? ENODEV : errno, "reading a report"));
    }
    if (wait_ms == 0) return hal::timed_out();
  }
}

hal::Result<void> HidTransport::write(std::span<const std::byte> from, std::int64_t /*deadline_ns*/) {
  return hal::fail(hal::ErrorCode::unsupported, description_.serial,
                   "an eye takes no stream of bytes (" + std::to_string(from.size()) + " given); use control()");
}

hal::Result<std::size_t> HidTransport::control(std::uint8_t request, std::span<const std::byte> payload,
                                               std::span<std::byte> reply, std::int64_t deadline_ns) {
  if (!connection_) return tl::unexpected(not_open());
  auto exchange = protocol::hid_exchange(request, payload, reply.size());
  if (!exchange) return tl::unexpected(std::move(exchange.error()));
  if (milliseconds_until(deadline_ns) == 0) return hal::timed_out();
  hid_device* const device = connection_->requests.get();
  if (exchange->has_set) {
    errno = 0;
    const int bytes = hid_send_feature_report(device, reinterpret_cast<const unsigned char*>(exchange->set.data()),
                                              exchange->set.size());
    if (bytes < 0) return tl::unexpected(failure(errno, "sending a feature report"));
  }
  if (!exchange->has_get) return std::size_t{0};
  protocol::HidReportBytes report{};
  report[0] = static_cast<std::byte>(exchange->get);
  errno = 0;
  const int bytes = hid_get_feature_report(device, reinterpret_cast<unsigned char*>(report.data()), report.size());
  if (bytes < 0) return tl::unexpected(failure(errno, "asking for a feature report"));
  const std::size_t count = std::min(static_cast<std::size_t>(bytes), report.size());
  return protocol::hid_reply(request, payload, std::span<const std::byte>(report).first(count), reply);
}

}  // namespace compueye::transport
