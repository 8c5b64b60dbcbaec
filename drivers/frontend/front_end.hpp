#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "hal/clock.hpp"
#include "hal/result.hpp"
#include "hal/signal_lines.hpp"
#include "hal/spi_bus.hpp"

namespace compueye::frontend {

/// How converters are wired and set.
struct FrontEndSettings {
  int chips = 1;               ///< behind one another (a daisy chain) or beside one another, see FrontEndRow::chain
  std::uint32_t clock_hz = 0;  ///< of the bus; 0: FrontEndRow::spi's
  double frame_rate_hz = 0.0;  ///< > 0
  int range = 0;               ///< of the inputs, an index into FrontEndRow::ranges
};

/// What the chips hang on. The front end opens and closes none of it.
struct Wiring {
  hal::SpiBus* data = nullptr;         ///< never null
  hal::SpiBus* settings = nullptr;     ///< where settings have wires of their own (DDC264), else null
  hal::OutputLines* select = nullptr;  ///< the number of the chip that `data` goes to; null where one chip select does
  hal::OutputLines* reset = nullptr;   ///< one line, low resets; null where the chip has none or it is not wired
};

/// What the bytes of one chip tell of themselves.
enum class ChipFault : std::uint8_t {
  none,
  crc_error,      ///< of the chip's own checksum
  wrong_place,    ///< marker bits or a channel's address are not where they belong: a lost or doubled clock
  stuck_low,      ///< nothing but zeros, which the chip cannot send
  stuck_high,     ///< nothing but ones, likewise
  lost_settings,  ///< the chip says, or shows, that it started anew
  no_new_sample,  ///< the chip says that it has converted nothing since the last time
};
inline constexpr std::size_t chip_fault_count = static_cast<std::size_t>(ChipFault::no_new_sample) + 1;

[[nodiscard]] std::string_view name(ChipFault fault) noexcept;

/// Chips by what their bytes told.
struct FrameReport {
  std::array<std::uint16_t, chip_fault_count> chips{};

  [[nodiscard]] int with(ChipFault fault) const noexcept { return chips[static_cast<std::size_t>(fault)]; }
};

/// One exchange of a frame: with the chip that `select` numbers, or with the chain.
struct Exchange {
  std::uint32_t select = 0;
  std::span<const hal::SpiSegment> segments;
};

/// The converters of an eye: which bytes go out for a frame, and what those that come back mean. Knows the chip and no
/// bus; nothing here waits or reads a clock after configure().
class FrontEnd {
 public:
  FrontEnd() = default;
  FrontEnd(const FrontEnd&) = delete;
  FrontEnd& operator=(const FrontEnd&) = delete;
  virtual ~FrontEnd() = default;

  /// M: channel c is input c % FrontEndRow::channels of chip c / FrontEndRow::channels, chip 0 being the first in the
  /// chain (whose data come first) or that of address 0.
  [[nodiscard]] virtual int channels() const noexcept = 0;

  /// Resets every chip, says what it is to do, and reads back that it understood. `wiring` is open and outlives the
  /// front end's use. Errors: mismatch (another chip, or none: chip, register, what was read and what is expected), and
  /// those of the wires.
  [[nodiscard]] virtual hal::Result<void> configure(const Wiring& wiring, hal::Clock& clock) = 0;

  /// What a frame takes, the same every time; what comes in goes to memory of the front end.
  [[nodiscard]] virtual std::span<const Exchange> frame() const noexcept = 0;

  /// What the last run of frame() brought: channels() codes from 0 to 2^bits - 1 and their validity. A chip with a
  /// fault has none valid; their codes are then 0. Does not use the heap.
  [[nodiscard]] virtual FrameReport decode(std::span<std::int32_t> codes, std::span<std::uint8_t> valid) noexcept = 0;
};

/// A range of inputs: what the chip's register says for it.
struct InputRange {
  std::string_view name;  ///< "0..10.24 V", "50 pC"
  std::uint16_t code = 0;
};

class ChipEmulator;

/// A kind of converter: all that is known of it without talking to one. To add one takes its file, a line in
/// front_end_list.cpp, and its emulator's file.
struct FrontEndRow {
  std::string_view name;        ///< of a board's [source] chip: "mcp3208"
  std::string_view title;       ///< "Microchip MCP3208"
  std::string_view datasheet;   ///< number and revision; pages are beside what they are cited for
  int channels = 0;             ///< of one chip
  int bits = 0;                 ///< depth of the codes; those of a bipolar input are offset by half
  hal::SpiMode spi;             ///< the mode, and the fastest clock that the chip takes
  bool chain = false;           ///< several chips are a daisy chain; otherwise they have an address each
  bool data_ready = false;      ///< the chip says when a frame is complete; otherwise the host sets the pace
  bool settings_bus = false;    ///< needs Wiring::settings
  double most_frames_hz = 0.0;  ///< of one chip, by the datasheet
  std::span<const InputRange> ranges = {};  ///< none where inputs have one range
  /// Error out_of_range names the setting and what the chip can do.
  hal::Result<std::unique_ptr<FrontEnd>> (*make)(const FrontEndSettings& settings) = nullptr;
  std::unique_ptr<ChipEmulator> (*emulate)() = nullptr;
};

/// Every kind.
[[nodiscard]] std::span<const FrontEndRow* const> front_ends() noexcept;
/// Null when there is none of that name.
[[nodiscard]] const FrontEndRow* find_front_end(std::string_view name) noexcept;

}  // namespace compueye::frontend
