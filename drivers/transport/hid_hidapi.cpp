#include "drivers/transport/hid_hidapi.hpp"

#include <hidapi/hidapi.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <limits>
#include <optional>
#include <utility>

#include "drivers/protocol/hid_control.hpp"
#include "drivers/protocol/hid_report.hpp"
#include "hal/clock.hpp"
#include "hal/try.hpp"

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

/// The protocol's texts are printable ASCII; anything else becomes '?'.
std::string ascii_of(const wchar_t* text) {
  std::string ascii;
  for (; text != nullptr && *text != L'\0'; ++text)
    ascii += *text >= L' ' && *text <= L'~' ? static_cast<char>(*text) : '?';
  return ascii;
}

hal::Error refusal_of(const std::string& path) {
  if (access(path.c_str(), R_OK | W_OK) == 0) return {};
  return {hal::ErrorCode::io, path, "permission denied; install boards/60-compueye.rules and plug the eye in again"};
}

hal::Result<FoundEye> find_eye(protocol::UsbIdentity identity, const std::string& serial) {
  std::vector<FoundEye> eyes = TRY(list_hid_eyes(identity));
  const auto found = std::find_if(eyes.begin(), eyes.end(),
                                  [&](const FoundEye& eye) { return serial.empty() || eye.serial == serial; });
  if (found == eyes.end()) return tl::unexpected(no_eye(protocol::hid_bus, serial, eyes));
  if (!found->reachable()) return tl::unexpected(std::move(found->refusal));
  return std::move(*found);
}

constexpr std::int64_t ns_per_ms = 1'000'000;

/// Rounded up, so that a deadline is never missed by early waking.
int milliseconds_until(std::int64_t deadline_ns) {
  const std::int64_t left_ns = deadline_ns - hal::MonotonicClock().now_ns();
  if (left_ns <= 0) return 0;
  return static_cast<int>(std::min<std::int64_t>((left_ns - 1) / ns_per_ms + 1, std::numeric_limits<int>::max()));
}

}  // namespace

hal::Result<std::vector<FoundEye>> list_hid_eyes(protocol::UsbIdentity identity) {
  if (hid_init() != 0) return hal::fail(hal::ErrorCode::io, "hid", "hidapi does not start on this machine");
  const std::unique_ptr<hid_device_info, void (*)(hid_device_info*)> list(
      hid_enumerate(identity.vendor, identity.product), hid_free_enumeration);
  std::vector<FoundEye> eyes;
  for (const hid_device_info* each = list.get(); each != nullptr; each = each->next) {
    if (each->path == nullptr) continue;
    const std::string path = each->path;
    // hidapi lists a device once for every usage it has.
    if (std::any_of(eyes.begin(), eyes.end(), [&](const FoundEye& eye) { return eye.path == path; })) continue;
    eyes.push_back({path.substr(path.rfind('/') + 1), path, ascii_of(each->serial_number),
                    ascii_of(each->product_string), refusal_of(path)});
  }
  std::sort(eyes.begin(), eyes.end(), [](const FoundEye& a, const FoundEye& b) { return a.bus < b.bus; });
  return eyes;
}

const Cable hid_cable{protocol::hid_bus, [] { return list_hid_eyes(); },
                      [](const std::string& serial) -> std::unique_ptr<hal::ByteTransport> {
                        HidSettings settings;
                        settings.serial = serial;
                        return std::make_unique<HidTransport>(std::move(settings));
                      }};

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
  const FoundEye eye = TRY(find_eye(settings_.identity, settings_.serial));
  auto connection = std::make_unique<Connection>();
  connection->path = eye.path;
  connection->input.reset(hid_open_path(eye.path.c_str()));
  connection->requests.reset(hid_open_path(eye.path.c_str()));
  connection->file = identity_of(eye.path);
  if (!connection->input || !connection->requests || !connection->file) {
    return hal::fail(hal::ErrorCode::io, eye.path,
                     "the device file does not open; plug the eye in again, and install boards/60-compueye.rules");
  }
  description_.bus = eye.bus;
  description_.serial = eye.serial;
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

hal::Result<std::size_t> HidTransport::control(std::uint8_t request, std::span<const std::byte> payload,
                                               std::span<std::byte> reply, std::int64_t deadline_ns) {
  if (!connection_) return tl::unexpected(not_open());
  const protocol::HidExchange exchange = TRY(protocol::hid_exchange(request, payload, reply.size()));
  if (milliseconds_until(deadline_ns) == 0) return hal::timed_out();
  hid_device* const device = connection_->requests.get();
  if (exchange.has_set) {
    errno = 0;
    const int bytes = hid_send_feature_report(device, reinterpret_cast<const unsigned char*>(exchange.set.data()),
                                              exchange.set.size());
    if (bytes < 0) return tl::unexpected(failure(errno, "sending a feature report"));
  }
  if (!exchange.has_get) return std::size_t{0};
  protocol::HidReportBytes report{};
  report[0] = static_cast<std::byte>(exchange.get);
  errno = 0;
  const int bytes = hid_get_feature_report(device, reinterpret_cast<unsigned char*>(report.data()), report.size());
  if (bytes < 0) return tl::unexpected(failure(errno, "asking for a feature report"));
  const std::size_t count = std::min(static_cast<std::size_t>(bytes), report.size());
  return protocol::hid_reply(request, payload, std::span<const std::byte>(report).first(count), reply);
}

}  // namespace compueye::transport
