#pragma once

#include <cstddef>
#include <cstdint>

namespace compueye::protocol {

/// Requests on the control channel. How hal::ByteTransport::control(request, payload, reply) carries one:
///
/// - USB: a vendor request to the device (bmRequestType 0x40 out, 0xC0 in), bRequest = the number below. With an empty
///   reply it goes OUT and the payload is its data stage (wValue = wIndex = 0). With a reply it goes IN, wLength = the
///   reply's size, and up to four payload bytes are wValue (the first two, little-endian) and wIndex.
/// - HID: feature reports, see hid_control.hpp.
///
/// A device answers within 100 ms. It refuses (stalls) what it does not know, a payload of the wrong length, a value
/// out of its limits and a request its state forbids; STATUS then says which (StatusError). A refusal changes nothing
/// else.
enum class Request : std::uint8_t {
  get_desc = 0x01,     ///< in: page u16, page_bytes u16 -> bytes page * page_bytes and on of the descriptor
  set_config = 0x02,   ///< out: Configuration, 16 B. Not while streaming
  get_config = 0x03,   ///< in -> the Configuration in force, 16 B; config_id 0: none
  start = 0x04,        ///< out: nothing. Only when configured and not streaming
  stop = 0x05,         ///< out: nothing. Ends the stream and empties the FIFO; in any state
  reset_pipes = 0x06,  ///< out: nothing. As STOP, and clears halted endpoints. A USB host clears its side's halt too
  set_illum = 0x07,    ///< out: Illumination, 8 B. In any state
  status = 0x08,       ///< in -> Status, 48 B. In any state
  ping = 0x09,         ///< in: nonce u32 -> PingReply, 8 B. In any state; the same in every version
};

/// Time within which a device answers a request.
inline constexpr std::int64_t control_deadline_ns = 100'000'000;

/// Linux limits the data of a control transfer to this (usbfs), so a descriptor travels in pages.
inline constexpr std::size_t most_control_bytes = 4096;

[[nodiscard]] constexpr std::uint8_t number(Request request) noexcept {
  return static_cast<std::uint8_t>(request);
}

}  // namespace compueye::protocol
