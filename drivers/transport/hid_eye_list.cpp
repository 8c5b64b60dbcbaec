#include "drivers/transport/hid_eye_list.hpp"

#include <hidapi/hidapi.h>
#include <unistd.h>

#include <algorithm>
#include <memory>
#include <utility>

namespace compueye::transport {
namespace {

/// The protocol's texts are printable ASCII; anything else becomes '?'.
std::string ascii_of(const wchar_t* text) {
  std::string ascii;
  for (; text != nullptr && *text != L'\0'; ++text)
    ascii += *text >= L' ' && *text <= L'~' ? static_cast<char>(*text) : '?';
  return ascii;
}

}  // namespace

hal::Result<std::vector<HidEye>> list_hid_eyes(protocol::UsbIdentity identity) {
  if (hid_init() != 0) return hal::fail(hal::ErrorCode::io, "hid", "hidapi does not start on this machine");
  const std::unique_ptr<hid_device_info, void (*)(hid_device_info*)> list(
      hid_enumerate(identity.vendor, identity.product), hid_free_enumeration);
  std::vector<HidEye> eyes;
  for (const hid_device_info* each = list.get(); each != nullptr; each = each->next) {
    if (each->path == nullptr) continue;
    const std::string path = each->path;
    // hidapi lists a device once for every usage it has.
    if (std::any_of(eyes.begin(), eyes.end(), [&](const HidEye& eye) { return eye.path == path; })) continue;
    eyes.push_back({path.substr(path.rfind('/') + 1), path, ascii_of(each->serial_number),
                    ascii_of(each->product_string), access(path.c_str(), R_OK | W_OK) == 0});
  }
  std::sort(eyes.begin(), eyes.end(), [](const HidEye& a, const HidEye& b) { return a.bus < b.bus; });
  return eyes;
}

hal::Result<HidEye> find_hid_eye(protocol::UsbIdentity identity, const std::string& serial) {
  auto eyes = list_hid_eyes(identity);
  if (!eyes) return tl::unexpected(std::move(eyes.error()));
  std::string others;
  for (HidEye& eye : *eyes) {
    if (serial.empty() || eye.serial == serial) {
      if (eye.reachable) return std::move(eye);
      return hal::fail(hal::ErrorCode::io, eye.path,
                       "permission denied; install boards/generic-hid/70-compueye.rules and plug the eye in again");
    }
    others += (others.empty() ? "" : ", ") + eye.serial + " (" + eye.bus + ")";
  }
  const std::string wanted = serial.empty() ? "no eye" : "no eye with serial '" + serial + "'";
  return hal::fail(hal::ErrorCode::not_found, serial.empty() ? "hid" : serial,
                   wanted + " is on HID" + (others.empty() ? "" : "; there are " + others) + "; plug it in");
}

}  // namespace compueye::transport
