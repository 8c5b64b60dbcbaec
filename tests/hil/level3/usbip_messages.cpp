#include "tests/hil/level3/usbip_messages.hpp"

#include <algorithm>

namespace compueye::hil {
namespace {

constexpr std::uint32_t most_bytes = 1U << 20U;
constexpr std::uint32_t from_device = 1;
// Offsets in a header.
constexpr std::size_t command_at = 0, number_at = 4, direction_at = 12, endpoint_at = 16;
constexpr std::size_t length_at = 24, setup_at = 40, unlinked_at = 20;  // of a request
constexpr std::size_t status_at = 20, moved_at = 24;                    // of an answer

std::uint32_t load(const UsbipHeader& header, std::size_t at) noexcept {
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < 4; ++k) value = value << 8U | std::to_integer<std::uint32_t>(header[at + k]);
  return value;
}

void store(UsbipHeader& header, std::size_t at, std::uint32_t value) noexcept {
  for (std::size_t k = 0; k < 4; ++k) header[at + k] = static_cast<std::byte>(value >> (24U - 8U * k) & 0xFFU);
}

/// Device, direction and endpoint are 0 in an answer.
UsbipHeader answer(UsbipCommand command, const UsbipRequest& request, int status) noexcept {
  UsbipHeader header{};
  store(header, command_at, static_cast<std::uint32_t>(command));
  store(header, number_at, request.number);
  store(header, status_at, static_cast<std::uint32_t>(status));
  return header;
}

}  // namespace

std::optional<UsbipRequest> parse_usbip(const UsbipHeader& header) noexcept {
  UsbipRequest request;
  request.command = static_cast<UsbipCommand>(load(header, command_at));
  request.number = load(header, number_at);
  if (request.command == UsbipCommand::unlink) {
    request.unlinked = load(header, unlinked_at);
    return request;
  }
  request.in = load(header, direction_at) == from_device;
  request.endpoint = load(header, endpoint_at);
  request.length = load(header, length_at);
  std::copy_n(header.begin() + setup_at, request.setup.size(), request.setup.begin());
  if (request.command != UsbipCommand::submit || request.length > most_bytes) return std::nullopt;
  return request;
}

UsbipHeader usbip_submitted(const UsbipRequest& request, int status, std::size_t bytes) noexcept {
  UsbipHeader header = answer(UsbipCommand::submitted, request, status);
  store(header, moved_at, static_cast<std::uint32_t>(bytes));
  return header;
}

UsbipHeader usbip_unlinked(const UsbipRequest& request, int status) noexcept {
  return answer(UsbipCommand::unlinked, request, status);
}

}  // namespace compueye::hil
