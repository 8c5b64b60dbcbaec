#include "firmware/sinks/terminal_sink.hpp"

#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "firmware/files/file_descriptor.hpp"

namespace compueye::firmware {
namespace {

constexpr std::string_view hide_cursor = "\x1b[?25l";
constexpr std::string_view show_cursor = "\x1b[?25h";
constexpr std::string_view plain = "\x1b[0m";
constexpr std::string_view clear_to_end_of_line = "\x1b[K";
constexpr std::string_view upper_half_block = "\xe2\x96\x80";
constexpr std::size_t longest_cell = 2 * 20 + 3;  // two 24-bit colours and the block
constexpr int no_colour = -1;

struct Size {
  int columns;
  int lines;
};

Size terminal_size(const TerminalOptions& options) {
  winsize asked{};
  const bool known = ::ioctl(options.fd, TIOCGWINSZ, &asked) == 0 && asked.ws_col > 0 && asked.ws_row > 0;
  const Size found = known ? Size{asked.ws_col, asked.ws_row} : Size{80, 24};
  return {std::clamp(options.columns > 0 ? options.columns : found.columns, 2, 2000),
          std::clamp(options.lines > 0 ? options.lines : found.lines, 2, 2000)};
}

// `shown` parts of `length` pixels, as equal as whole pixels allow; enlarged by a whole number when there is room.
std::vector<int> edges(int length, int shown) {
  std::vector<int> at(static_cast<std::size_t>(shown) + 1);
  for (std::size_t i = 0; i < at.size(); ++i) {
    at[i] = static_cast<int>(static_cast<std::int64_t>(i) * length / shown);
  }
  return at;
}

int palette_grey(int code) {
  // 24 greys 8, 18, ... 238 from 232 on; black and white are in the colour cube.
  if (code < 4) return 16;
  if (code > 246) return 231;
  return 232 + std::clamp((code - 8 + 5) / 10, 0, 23);
}

}  // namespace

TerminalColours terminal_colours_from_environment() {
  const char* text = std::getenv("COLORTERM");
  const bool full = text != nullptr && (std::strcmp(text, "truecolor") == 0 || std::strcmp(text, "24bit") == 0);
  return full ? TerminalColours::truecolor : TerminalColours::palette;
}

TerminalSink::~TerminalSink() {
  static_cast<void>(TerminalSink::close());
}

void TerminalSink::lay_out() {
  const Size size = terminal_size(options_);
  // One line below the picture is for the frame number.
  const int room_cols = size.columns, room_rows = 2 * (size.lines - 1);
  const double fit =
      std::min(static_cast<double>(room_cols) / format_.cols, static_cast<double>(room_rows) / format_.rows);
  const double zoom = fit >= 1.0 ? std::floor(fit) : fit;
  const auto scaled = [zoom](int length, int room) {
    return std::clamp(static_cast<int>(std::lround(length * zoom)), 1, room);
  };
  row_edges_ = edges(format_.rows, scaled(format_.rows, room_rows));
  col_edges_ = edges(format_.cols, scaled(format_.cols, room_cols));
}

hal::Result<void> TerminalSink::open(hal::FrameFormat format) {
  if (open_ || format.rows < 1 || format.cols < 1) {
    return hal::fail(hal::ErrorCode::usage, "terminal",
                     open_ ? "is already open, expected a close() first"
                           : "was to show " + std::to_string(format.rows) + " x " + std::to_string(format.cols) +
                                 " pixels, expected at least 1 x 1");
  }
  format_ = format;
  lay_out();
  const auto rows = static_cast<std::size_t>(shown_rows()), cols = static_cast<std::size_t>(shown_cols());
  buffer_.assign(cols * (rows / 2 + 1) * longest_cell + (rows / 2 + 2) * 16 + 256, '\0');
  used_ = 0;
  shown_ = 0;
  anything_drawn_ = false;
  open_ = true;
  put(hide_cursor);
  auto ok = send();
  open_ = ok.has_value();
  return ok;
}

// The mean of the pixels behind one half block; where the picture is enlarged that is one pixel.
int TerminalSink::grey_at(const hal::Frame& frame, int row, int col) const noexcept {
  const auto r = static_cast<std::size_t>(row), c = static_cast<std::size_t>(col);
  const int top = row_edges_[r], bottom = std::max(row_edges_[r + 1], top + 1);
  const int left = col_edges_[c], right = std::max(col_edges_[c + 1], left + 1);
  float sum = 0.0F;
  for (int i = top; i < bottom; ++i) {
    const std::size_t begin = static_cast<std::size_t>(i) * static_cast<std::size_t>(format_.cols);
    for (int j = left; j < right; ++j) sum += frame.pixels[begin + static_cast<std::size_t>(j)];
  }
  const float mean = sum / static_cast<float>((bottom - top) * (right - left));
  const float shown = mean > 0.0F ? std::min(mean, 1.0F) : 0.0F;
  return static_cast<int>(std::lround(shown * 255.0F));
}

void TerminalSink::put(std::string_view text) noexcept {
  const std::size_t n = std::min(text.size(), buffer_.size() - used_);
  std::memcpy(buffer_.data() + used_, text.data(), n);
  used_ += n;
}

void TerminalSink::put_number(std::uint64_t value) noexcept {
  char digits[20];
  const auto end = std::to_chars(digits, digits + sizeof digits, value).ptr;
  put(std::string_view(digits, static_cast<std::size_t>(end - digits)));
}

void TerminalSink::put_colour(bool foreground, int code) noexcept {
  const auto grey = static_cast<std::uint64_t>(code);
  if (options_.colours == TerminalColours::palette) {
    put(foreground ? "\x1b[38;5;" : "\x1b[48;5;");
    put_number(grey);
  } else {
    put(foreground ? "\x1b[38;2;" : "\x1b[48;2;");
    put_number(grey);
    put(";");
    put_number(grey);
    put(";");
    put_number(grey);
  }
  put("m");
}

void TerminalSink::put_line(const hal::Frame& frame, int line) noexcept {
  const bool has_lower = 2 * line + 1 < shown_rows();
  int upper = no_colour, lower = no_colour;
  for (int c = 0; c < shown_cols(); ++c) {
    const auto colour = [&](int row) {
      const int code = grey_at(frame, row, c);
      return options_.colours == TerminalColours::palette ? palette_grey(code) : code;
    };
    // Colours stay until they change: most neighbours are alike, and a serial console is slow.
    if (const int now = colour(2 * line); now != upper) put_colour(true, upper = now);
    if (has_lower) {
      if (const int now = colour(2 * line + 1); now != lower) put_colour(false, lower = now);
    }
    put(upper_half_block);
  }
  put(plain);
  put(clear_to_end_of_line);
  put("\n");
}

hal::Result<void> TerminalSink::write(const hal::Frame& frame) {
  const std::size_t pixels = static_cast<std::size_t>(format_.rows) * static_cast<std::size_t>(format_.cols);
  if (!open_ || frame.pixels.size() != pixels) {
    return hal::fail(hal::ErrorCode::usage, "terminal",
                     open_ ? "was given a picture of " + std::to_string(frame.pixels.size()) + " pixels, expected " +
                                 std::to_string(pixels)
                           : std::string("is not open, expected an open() first"));
  }
  const std::int64_t now = clock_->now_ns();
  if (anything_drawn_ && now - last_ns_ < options_.min_interval_ns) return {};
  const int lines = (shown_rows() + 1) / 2;
  if (anything_drawn_) {
    put("\r\x1b[");
    put_number(static_cast<std::uint64_t>(lines));
    put("A");
  }
  for (int line = 0; line < lines; ++line) put_line(frame, line);
  put("frame ");
  put_number(frame.frame);
  put(clear_to_end_of_line);
  last_ns_ = now;
  anything_drawn_ = true;
  ++shown_;
  return send();
}

hal::Result<void> TerminalSink::close() {
  if (!open_) return {};
  open_ = false;
  put(plain);
  put(show_cursor);
  if (anything_drawn_) put("\n");
  return send();
}

hal::Result<void> TerminalSink::send() {
  const char* at = buffer_.data();
  std::size_t left = used_;
  used_ = 0;
  while (left > 0) {
    const ssize_t put_bytes = ::write(options_.fd, at, left);
    if (put_bytes > 0) {
      at += put_bytes;
      left -= static_cast<std::size_t>(put_bytes);
    } else if (put_bytes < 0 && errno == EAGAIN) {
      // Somebody made the terminal non-blocking; a stopped one must not hold the run for ever.
      pollfd ready{options_.fd, POLLOUT, 0};
      if (::poll(&ready, 1, 1000) == 0) {
        return hal::fail(hal::ErrorCode::io, "terminal", "takes no output; is it stopped (Ctrl-S)?");
      }
    } else if (put_bytes == 0 || errno != EINTR) {
      return tl::unexpected(file_error(put_bytes == 0 ? EIO : errno, "terminal", "cannot be written"));
    }
  }
  return {};
}

}  // namespace compueye::firmware
