#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "drivers/protocol/descriptor.hpp"
#include "drivers/protocol/hid_control.hpp"
#include "drivers/protocol/hid_report.hpp"
#include "drivers/protocol/requests.hpp"
#include "drivers/protocol/sample_format.hpp"

namespace compueye::protocol {

/// How an eye names itself on USB: vendor and product of the device descriptor. Those of pid.codes for private tests;
/// an eye that is sold needs numbers of its own.
struct UsbIdentity {
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
};

/// What the stream is made of, and with it what requests are.
enum class Framing : std::uint8_t {
  packets,  ///< packet_stream.hpp: packets behind one another, cut anywhere by reads; requests as they are
  reports,  ///< hid_report.hpp: a read is one report; requests are feature reports (hid_control.hpp)
};

/// A kind of cable: everything that the driver and the emulated eye need to know of it. To add one takes five files:
///
///   drivers/protocol/bus.hpp             its row, and the row's name in `buses`
///   drivers/transport/<bus>_<library>.*  the transport, two files, and what it finds there (transport::Cable)
///   drivers/transport/CMakeLists.txt     its target
///   firmware/eye/source_list.cpp         a line: boards can name it, and `compueye devices` looks at it
///
/// A stream that is neither packets nor reports takes a Framing besides: device::make_stream_reader() and
/// DeviceEmulator::expose(). There are no hot-plug events in it: a source that lost its eye opens the transport again
/// and again, and open() looks for the eye anew.
struct Bus {
  std::string_view name;                      ///< of a board's [source] kind and hal::SourceDescription::backend
  std::string_view title;                     ///< in sentences
  Framing framing = Framing::packets;         //
  std::size_t report_bytes = 0;               ///< a read is one report of so many bytes; 0: as many bytes as there are
  std::size_t page_bytes = 0;                 ///< of the descriptor, that one request carries
  int most_channels = 0, most_bits = 0;       ///< of an eye that it can carry
  std::optional<SampleFormat> only_format;    ///< the one that it carries; nothing: all
  UsbIdentity identity;                       ///< where it is plugged into USB
  bool holds_back = false;                    ///< bytes that nobody reads wait in the device instead of being lost
  double emulated_bytes_per_s = 0.0;          ///< of an emulated link
  std::size_t emulated_max_packet_bytes = 0;  ///< of an emulated transport

  [[nodiscard]] bool carries(const DeviceDescriptor& device) const noexcept {
    return device.channels <= most_channels && device.bits <= most_bits;
  }
  [[nodiscard]] bool carries(SampleFormat format) const noexcept { return !only_format || *only_format == format; }
};

/// Vendor requests on EP0 and one bulk-in endpoint.
inline constexpr Bus usb_bus{.name = "usb",
                             .title = "USB",
                             .framing = Framing::packets,
                             .report_bytes = 0,
                             .page_bytes = most_control_bytes,
                             .most_channels = 65535,
                             .most_bits = 24,
                             .only_format = std::nullopt,
                             .identity = {0x1209, 0x0001},
                             .holds_back = true,
                             .emulated_bytes_per_s = 35e6,
                             .emulated_max_packet_bytes = 512};

/// A HID device with reports of 64 bytes, one a millisecond.
inline constexpr Bus hid_bus{.name = "hid",
                             .title = "HID",
                             .framing = Framing::reports,
                             .report_bytes = hid_report_bytes,
                             .page_bytes = hid_page_bytes,
                             .most_channels = hid_most_channels,
                             .most_bits = hid_bits,
                             .only_format = SampleFormat::u12,
                             .identity = {0x1209, 0x0002},
                             .holds_back = false,
                             .emulated_bytes_per_s = 64e3,
                             .emulated_max_packet_bytes = hid_report_bytes};

/// A UART, of 115,200 bits a second where nothing else is said. It is none of `buses`: no board can name it yet.
inline constexpr Bus uart_bus{.name = "uart",
                              .title = "UART",
                              .framing = Framing::packets,
                              .report_bytes = 0,
                              .page_bytes = 256,
                              .most_channels = 65535,
                              .most_bits = 24,
                              .only_format = std::nullopt,
                              .identity = {},
                              .holds_back = false,
                              .emulated_bytes_per_s = 11'520,
                              .emulated_max_packet_bytes = 1};

inline constexpr std::array buses{&usb_bus, &hid_bus};

/// What one frame of samples takes on a bus.
struct FrameSize {
  std::size_t packets = 0;  ///< or reports
  std::size_t bytes = 0;    ///< at most
};
[[nodiscard]] FrameSize frame_size(const Bus& bus, const DeviceDescriptor& device, SampleFormat format) noexcept;

}  // namespace compueye::protocol
