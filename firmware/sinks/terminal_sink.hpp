#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "hal/clock.hpp"
#include "hal/frame_sink.hpp"

namespace compueye::firmware {

enum class TerminalColours : std::uint8_t {
  truecolor,  ///< 24 bits, 256 greys
  palette,    ///< the 256-colour palette, 26 greys: for terminals without 24-bit colour
};

struct TerminalOptions {
  int fd = 1;  ///< not owned
  TerminalColours colours = TerminalColours::truecolor;
  int columns = 0;                            ///< width in characters; 0 = ask the terminal, 80 when it does not say
  int lines = 0;                              ///< height in characters; 0 = ask the terminal, 24 when it does not say
  std::int64_t min_interval_ns = 66'000'000;  ///< frames that come sooner after the last one shown are passed over
};

/// truecolor when the environment says that the terminal can (COLORTERM=truecolor or 24bit), otherwise palette.
[[nodiscard]] TerminalColours terminal_colours_from_environment();

/// A live picture in a terminal: two pixels a character (the upper half block, foreground above background), scaled
/// down by averaging or up by whole numbers, redrawn in place, with the frame number below. Intensities 0..1 become
/// black to white, clipped. The size is asked for once, in open(); write() does not allocate.
class TerminalSink final : public hal::FrameSink {
 public:
  /// `clock` must outlive the sink.
  TerminalSink(const hal::Clock& clock, TerminalOptions options) : clock_(&clock), options_(options) {}
  TerminalSink(const TerminalSink&) = delete;
  TerminalSink& operator=(const TerminalSink&) = delete;
  ~TerminalSink() override;

  /// Hides the cursor. Errors: usage (no pixels, already open), io.
  [[nodiscard]] hal::Result<void> open(hal::FrameFormat format) override;
  [[nodiscard]] hal::Result<void> write(const hal::Frame& frame) override;
  /// Leaves the last picture on the screen and gives the cursor and the colours back.
  [[nodiscard]] hal::Result<void> close() override;

  /// Size of the picture on the screen in half blocks.
  [[nodiscard]] int shown_rows() const noexcept { return static_cast<int>(row_edges_.size()) - 1; }
  [[nodiscard]] int shown_cols() const noexcept { return static_cast<int>(col_edges_.size()) - 1; }
  [[nodiscard]] std::uint64_t frames_shown() const noexcept { return shown_; }

 private:
  void lay_out();
  [[nodiscard]] int grey_at(const hal::Frame& frame, int row, int col) const noexcept;
  void put(std::string_view text) noexcept;
  void put_number(std::uint64_t value) noexcept;
  void put_colour(bool foreground, int code) noexcept;
  void put_line(const hal::Frame& frame, int line) noexcept;
  [[nodiscard]] hal::Result<void> send();

  const hal::Clock* clock_;
  TerminalOptions options_;
  hal::FrameFormat format_;
  bool open_ = false;
  bool anything_drawn_ = false;
  std::int64_t last_ns_ = 0;
  std::uint64_t shown_ = 0;
  std::vector<int> row_edges_;  // shown row r averages the picture's rows row_edges_[r] to row_edges_[r + 1] - 1
  std::vector<int> col_edges_;
  std::string buffer_;
  std::size_t used_ = 0;
};

}  // namespace compueye::firmware
