#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/files/output_stream.hpp"
#include "firmware/sinks/live_status.hpp"
#include "hal/clock.hpp"
#include "hal/frame_sink.hpp"

namespace compueye::firmware {

enum class TerminalColours : std::uint8_t {
  truecolor,  ///< 24 bits, 256 greys
  palette,    ///< the 256-colour palette, 26 greys: for terminals without 24-bit colour
  none,       ///< ASCII characters from light to dense
};

/// What a terminal can show.
struct TerminalLook {
  TerminalColours colours = TerminalColours::truecolor;
  bool half_blocks = true;  ///< two pixels a character, which needs UTF-8

  bool operator==(const TerminalLook&) const = default;
};

struct TerminalOptions {
  int fd = 1;  ///< not owned
  TerminalLook look;
  int columns = 0;                            ///< width in characters; 0 = ask the terminal, 80 when it does not say
  int lines = 0;                              ///< height in characters; 0 = ask the terminal, 24 when it does not say
  std::int64_t min_interval_ns = 66'000'000;  ///< frames that come sooner after the last one shown are passed over
};

/// What the environment says: NO_COLOR asks for characters, COLORTERM (truecolor or 24bit) offers 24 bits, and half
/// blocks want a locale (LC_ALL, LC_CTYPE or LANG) of UTF-8.
[[nodiscard]] TerminalLook terminal_look_from_environment();

/// Whether the terminal obeys the escape sequences that a picture needs: TERM is set and not "dumb".
[[nodiscard]] bool terminal_can_draw();

/// A live picture in a terminal: two pixels a character (the upper half block, foreground above background) where it
/// can, scaled down by averaging or up by whole numbers, redrawn in place, with the frame number and how the run goes
/// below. A picture that the status says is held is called so, and one that is gone is blanked. Intensities 0..1 become
/// black to white, clipped. The picture follows the size of the terminal; write() does not allocate but when that has
/// grown.
///
/// A terminal that takes nothing (Ctrl-S, a hung connection) never holds the caller: its frames are passed over.
class TerminalSink final : public hal::FrameSink {
 public:
  /// `clock` and `status`, which may be null, must outlive the sink.
  TerminalSink(const hal::Clock& clock, TerminalOptions options, const LiveStatus* status = nullptr);
  TerminalSink(const TerminalSink&) = delete;
  TerminalSink& operator=(const TerminalSink&) = delete;
  ~TerminalSink() override;

  /// Hides the cursor. Errors: usage (no pixels, already open), io.
  [[nodiscard]] hal::Result<void> open(hal::FrameFormat format) override;
  [[nodiscard]] hal::Result<void> write(const hal::Frame& frame) override;
  /// Leaves the last picture on the screen and gives the cursor and the colours back.
  [[nodiscard]] hal::Result<void> close() override;

  // From any thread.
  /// Draws the line below the picture anew when no frame has done so for a while, and blanks a picture that is gone.
  void tell() noexcept;
  /// Cursor and colours as they were, and nothing more is drawn: before the process stops or is left.
  void give_back() noexcept;
  /// The process goes on: draws anew from the cursor on.
  void take_again() noexcept;

  /// Size of the picture on the screen in half blocks.
  [[nodiscard]] int shown_rows() const noexcept { return static_cast<int>(row_edges_.size()) - 1; }
  [[nodiscard]] int shown_cols() const noexcept { return static_cast<int>(col_edges_.size()) - 1; }
  [[nodiscard]] std::uint64_t frames_shown() const noexcept { return shown_; }
  /// Because the terminal took nothing.
  [[nodiscard]] std::uint64_t frames_passed_over() const noexcept { return passed_over_; }

 private:
  /// Columns and lines.
  struct Size {
    int columns = 0;
    int lines = 0;
    bool operator==(const Size&) const = default;
  };

  [[nodiscard]] Size size_now() const noexcept;
  void lay_out(Size size);
  void draw(const hal::Frame& frame, std::int64_t now_ns) noexcept;
  [[nodiscard]] float brightness_at(const hal::Frame& frame, int row, int col) const noexcept;
  void put(std::string_view text) noexcept;
  void put_number(std::uint64_t value) noexcept;
  void put_colour(bool foreground, int code) noexcept;
  [[nodiscard]] int code_of(float brightness) const noexcept;
  void put_half_blocks(const hal::Frame& frame, int line) noexcept;
  void put_cells(const hal::Frame& frame, int line) noexcept;
  void put_status(std::int64_t now_ns) noexcept;
  [[nodiscard]] hal::Result<void> send() noexcept;

  const hal::Clock* clock_;
  TerminalOptions options_;
  OutputStream out_;
  StatusLine status_line_;
  const LiveStatus* status_;

  std::mutex mutex_;  // of all below: the picture's thread and whoever gives the terminal back
  hal::FrameFormat format_;
  Size size_;
  bool open_ = false;
  bool given_back_ = false;
  bool anew_ = false;
  bool anything_drawn_ = false;
  bool blanked_ = false;
  bool line_begun_ = false;  // that of the first frame, before it
  std::uint64_t frame_ = 0;  // the last one drawn
  std::int64_t last_ns_ = 0;
  std::uint64_t shown_ = 0;
  std::uint64_t passed_over_ = 0;
  std::vector<float> black_;    // a picture
  std::vector<int> row_edges_;  // shown row r averages the picture's rows row_edges_[r] to row_edges_[r + 1] - 1
  std::vector<int> col_edges_;
  std::string buffer_;
  std::size_t used_ = 0;
  std::size_t sent_ = 0;  // of them
};

}  // namespace compueye::firmware
