#include "drivers/protocol/version.hpp"

#include <string>

namespace compueye::protocol {
namespace {

std::string text(ProtocolVersion version) {
  return std::to_string(version.major_number) + "." + std::to_string(version.minor_number);
}

}  // namespace

Compatibility compatibility(ProtocolVersion device) noexcept {
  if (device.major_number != host_version.major_number) return Compatibility::other_major;
  if (device.minor_number == host_version.minor_number) return Compatibility::same;
  return device.minor_number < host_version.minor_number ? Compatibility::older_minor : Compatibility::newer_minor;
}

hal::Result<void> check_version(ProtocolVersion device, std::string_view place) {
  if (compatibility(device) != Compatibility::other_major) return {};
  const bool old_device = device.major_number < host_version.major_number;
  return hal::fail(hal::ErrorCode::unsupported, std::string(place),
                   "the device speaks protocol " + text(device) + " and this program " + text(host_version) +
                       "; update the " + (old_device ? "device's firmware" : "program"));
}

}  // namespace compueye::protocol
