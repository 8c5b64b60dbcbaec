#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

/// The messages of USB/IP once a device is attached: Documentation/usb/usbip_protocol.rst of Linux, version 1.1.1. All
/// numbers are big-endian; a setup packet is as on the wire.
namespace compueye::hil {

inline constexpr std::size_t usbip_header_bytes = 48;
using UsbipHeader = std::array<std::byte, usbip_header_bytes>;

enum class UsbipCommand : std::uint32_t { submit = 1, unlink = 2, submitted = 3, unlinked = 4 };

/// What a host asks for: USBIP_CMD_SUBMIT or USBIP_CMD_UNLINK.
struct UsbipRequest {
  UsbipCommand command = UsbipCommand::submit;
  std::uint32_t number = 0;  ///< of this request
  bool in = false;           ///< towards the host
  std::uint32_t endpoint = 0;
  std::uint32_t length = 0;  ///< of its buffer, which follows a submission that is not `in`
  std::array<std::byte, 8> setup{};
  std::uint32_t unlinked = 0;  ///< number of the request that is to end
};

/// Nothing where it is neither, or a buffer is longer than 1 MiB, which no driver here asks for.
[[nodiscard]] std::optional<UsbipRequest> parse_usbip(const UsbipHeader& header) noexcept;

/// USBIP_RET_SUBMIT: `status` is 0 or a negative error number; `bytes` that were moved, which follow where it was `in`.
[[nodiscard]] UsbipHeader usbip_submitted(const UsbipRequest& request, int status, std::size_t bytes) noexcept;
/// USBIP_RET_UNLINK: -ECONNRESET where the request had not ended, 0 where it had.
[[nodiscard]] UsbipHeader usbip_unlinked(const UsbipRequest& request, int status) noexcept;

}  // namespace compueye::hil
