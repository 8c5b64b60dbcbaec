#include "firmware/sinks/terminal_sink.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdlib>

#include "firmware/files/file_descriptor.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

constexpr std::string_view hide_cursor = "\x1b[?25l";
constexpr std::string_view show_cursor = "\x1b[?25h";
constexpr std::string_view home_and_clear = "\x1b[H\x1b[2J";
constexpr std::string_view plain = "\x1b[0m";
constexpr std::string_view clear_to_end_of_line = "\x1b[K";
constexpr std::string_view upper_half_block = "\xe2\x96\x80";
constexpr std::size_t longest_cell = 2 * 20 + 3;  // two 24-bit colours and the block
constexpr int no_colour = -1;
constexpr std::string_view ramp = " .:-=+*#%@";
constexpr std::size_t longest_status = 160;
const LiveStatus nobodys_status;

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

TerminalLook terminal_look_from_environment() {
  const auto given = [](const char* variable) {
    const char* const text = std::getenv(variable);
    return std::string_view(text == nullptr ? "" : text);
  };
  TerminalLook look;
  const std::string_view colours = given("COLORTERM");
  const bool full = colours == "truecolor" || colours == "24bit";
  look.colours = !given("NO_COLOR").empty() ? TerminalColours::none
                 : full                     ? TerminalColours::truecolor
                                            : TerminalColours::palette;
  look.half_blocks = false;
  for (const char* variable : {"LC_ALL", "LC_CTYPE", "LANG"}) {
    const std::string_view locale = given(variable);
    if (locale.empty()) continue;
    const auto has = [&](std::string_view encoding) { return locale.find(encoding) != std::string_view::npos; };
    look.half_blocks = has(".UTF-8") || has(".utf8") || has(".utf-8") || has(".UTF8");
    break;
  }
  return look;
}

bool terminal_can_draw() {
  const char* const term = std::getenv("TERM");
  return term != nullptr && *term != '\0' && std::string_view(term) != "dumb";
}

TerminalSink::TerminalSink(const hal::Clock& clock, TerminalOptions options, const LiveStatus* status)
    : clock_(&clock),
      options_(options),
      out_(options.fd),
      status_line_(status != nullptr ? *status : nobodys_status),
      status_(status) {}

TerminalSink::~TerminalSink() {
  static_cast<void>(TerminalSink::close());
}

TerminalSink::Size TerminalSink::size_now() const noexcept {
  winsize asked{};
  const bool known = ::ioctl(options_.fd, TIOCGWINSZ, &asked) == 0 && asked.ws_col > 0 && asked.ws_row > 0;
  const Size found = known ? Size{asked.ws_col, asked.ws_row} : Size{80, 24};
  return {std::clamp(options_.columns > 0 ? options_.columns : found.columns, 2, 2000),
          std::clamp(options_.lines > 0 ? options_.lines : found.lines, 2, 2000)};
}

void TerminalSink::lay_out(Size size) {
  size_ = size;
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
  const auto rows = static_cast<std::size_t>(shown_rows()), cols = static_cast<std::size_t>(shown_cols());
  const std::size_t room = cols * (rows / 2 + 1) * longest_cell + (rows / 2 + 2) * 16 + longest_status + 256;
  if (buffer_.size() < room) buffer_.resize(room);
}

hal::Result<void> TerminalSink::open(hal::FrameFormat format) {
  const std::lock_guard lock(mutex_);
  if (open_ || format.rows < 1 || format.cols < 1) {
    return hal::fail(hal::ErrorCode::usage, "terminal",
                     open_ ? "is already open, expected a close() first"
                           : "was to show " + std::to_string(format.rows) + " x " + std::to_string(format.cols) +
                                 " pixels, expected at least 1 x 1");
  }
  format_ = format;
  black_.assign(static_cast<std::size_t>(format.rows) * static_cast<std::size_t>(format.cols), 0.0F);
  lay_out(size_now());
  used_ = sent_ = 0;
  shown_ = passed_over_ = 0;
  last_ns_ = clock_->now_ns();
  anything_drawn_ = line_begun_ = given_back_ = anew_ = blanked_ = false;
  put(hide_cursor);
  auto ok = send();
  open_ = ok.has_value();
  return ok;
}

/// The mean of the pixels behind one half block, 0..1; where the picture is enlarged that is one pixel.
float TerminalSink::brightness_at(const hal::Frame& frame, int row, int col) const noexcept {
  const auto r = static_cast<std::size_t>(row), c = static_cast<std::size_t>(col);
  const int top = row_edges_[r], bottom = std::max(row_edges_[r + 1], top + 1);
  const int left = col_edges_[c], right = std::max(col_edges_[c + 1], left + 1);
  float sum = 0.0F;
  for (int i = top; i < bottom; ++i) {
    const std::size_t begin = static_cast<std::size_t>(i) * static_cast<std::size_t>(format_.cols);
    for (int j = left; j < right; ++j) sum += frame.pixels[begin + static_cast<std::size_t>(j)];
  }
  const float mean = sum / static_cast<float>((bottom - top) * (right - left));
  return mean > 0.0F ? std::min(mean, 1.0F) : 0.0F;
}

void TerminalSink::put(std::string_view text) noexcept {
  const std::string_view taken = text.substr(0, buffer_.size() - used_);
  std::copy(taken.begin(), taken.end(), buffer_.begin() + static_cast<std::ptrdiff_t>(used_));
  used_ += taken.size();
}

void TerminalSink::put_number(std::uint64_t value) noexcept {
  char digits[20];
  const auto end = std::to_chars(digits, digits + sizeof digits, value).ptr;
  put(std::string_view(digits, static_cast<std::size_t>(end - digits)));
}

int TerminalSink::code_of(float brightness) const noexcept {
  const int grey = static_cast<int>(std::lround(brightness * 255.0F));
  return options_.look.colours == TerminalColours::palette ? palette_grey(grey) : grey;
}

void TerminalSink::put_colour(bool foreground, int code) noexcept {
  const auto grey = static_cast<std::uint64_t>(code);
  const bool palette = options_.look.colours == TerminalColours::palette;
  put(foreground ? "\x1b[38;" : "\x1b[48;");
  put(palette ? "5;" : "2;");
  for (int k = palette ? 2 : 0; k < 3; ++k) {
    put_number(grey);
    put(k < 2 ? ";" : "m");
  }
}

void TerminalSink::put_half_blocks(const hal::Frame& frame, int line) noexcept {
  const bool has_lower = 2 * line + 1 < shown_rows();
  int upper = no_colour, lower = no_colour;
  for (int c = 0; c < shown_cols(); ++c) {
    const auto colour = [&](int row) { return code_of(brightness_at(frame, row, c)); };
    // Colours stay until they change: most neighbours are alike, and a serial console is slow.
    if (const int now = colour(2 * line); now != upper) put_colour(true, upper = now);
    if (has_lower) {
      if (const int now = colour(2 * line + 1); now != lower) put_colour(false, lower = now);
    }
    put(upper_half_block);
  }
}

/// A character of ASCII for two pixels.
void TerminalSink::put_cells(const hal::Frame& frame, int line) noexcept {
  int background = no_colour;
  const int lower = std::min(2 * line + 1, shown_rows() - 1);
  for (int c = 0; c < shown_cols(); ++c) {
    const float mean = 0.5F * (brightness_at(frame, 2 * line, c) + brightness_at(frame, lower, c));
    if (options_.look.colours == TerminalColours::none) {
      put(ramp.substr(static_cast<std::size_t>(std::lround(mean * static_cast<float>(ramp.size() - 1))), 1));
      continue;
    }
    if (const int now = code_of(mean); now != background) put_colour(false, background = now);
    put(" ");
  }
}

void TerminalSink::put_status(std::int64_t now_ns) noexcept {
  // The last column stays free: a character there makes some terminals wrap.
  char text[longest_status];
  const auto room = static_cast<std::size_t>(std::min(size_.columns, static_cast<int>(sizeof text)));
  const std::size_t begin = used_;
  if (anything_drawn_) {
    const PictureAge age = status_ != nullptr ? status_->picture() : PictureAge::fresh;
    put(age == PictureAge::gone ? "NO PICTURE since frame " : age == PictureAge::held ? "HELD frame " : "frame ");
    put_number(frame_);
  } else {
    put("no frame yet");
  }
  const std::size_t taken = used_ - begin;
  if (status_ != nullptr && taken + 3 < room) {
    put("  ");
    put(status_line_.print(now_ns, std::span(text, room - taken - 2)));
  }
  put(clear_to_end_of_line);
}

void TerminalSink::draw(const hal::Frame& frame, std::int64_t now_ns) noexcept {
  const int lines = (shown_rows() + 1) / 2;
  if (anything_drawn_) {
    put("\r\x1b[");
    put_number(static_cast<std::uint64_t>(lines));
    put("A");
  } else if (line_begun_) {
    put("\r");
  }
  anything_drawn_ = true;
  const bool half_blocks = options_.look.half_blocks && options_.look.colours != TerminalColours::none;
  for (int line = 0; line < lines; ++line) {
    half_blocks ? put_half_blocks(frame, line) : put_cells(frame, line);
    put(plain);
    put(clear_to_end_of_line);
    put("\n");
  }
  frame_ = frame.frame;
  put_status(now_ns);
}

hal::Result<void> TerminalSink::write(const hal::Frame& frame) {
  const std::lock_guard lock(mutex_);
  const std::size_t pixels = static_cast<std::size_t>(format_.rows) * static_cast<std::size_t>(format_.cols);
  if (!open_ || frame.pixels.size() != pixels) {
    return hal::fail(hal::ErrorCode::usage, "terminal",
                     open_ ? "was given a picture of " + std::to_string(frame.pixels.size()) + " pixels, expected " +
                                 std::to_string(pixels)
                           : std::string("is not open, expected an open() first"));
  }
  const std::int64_t now = clock_->now_ns();
  if (given_back_ || (anything_drawn_ && now - last_ns_ < options_.min_interval_ns)) return {};
  TRY(send());
  if (sent_ < used_) {
    ++passed_over_;
    return {};
  }
  const Size size = size_now();
  if (size != size_ || anew_) {
    if (size != size_) put(home_and_clear);
    lay_out(size);
    put(hide_cursor);
    anything_drawn_ = anew_ = false;
  }
  draw(frame, now);
  blanked_ = false;
  last_ns_ = now;
  ++shown_;
  return send();
}

void TerminalSink::tell() noexcept {
  constexpr std::int64_t quiet_ns = 500'000'000;
  const std::lock_guard lock(mutex_);
  const std::int64_t now = clock_->now_ns();
  if (!open_ || given_back_ || anew_ || now - last_ns_ < quiet_ns || !send() || sent_ < used_) return;
  if (size_now() != size_) return;
  if (anything_drawn_ && !blanked_ && status_ != nullptr && status_->picture() == PictureAge::gone) {
    draw({black_, format_, frame_, 0}, now);
    blanked_ = true;
    static_cast<void>(send());
    return;
  }
  put("\r");
  put_status(now);
  line_begun_ = !anything_drawn_;
  static_cast<void>(send());
}

void TerminalSink::give_back() noexcept {
  const std::lock_guard lock(mutex_);
  if (!open_ || given_back_) return;
  given_back_ = true;
  used_ = sent_ = 0;
  put(plain);
  put(show_cursor);
  put("\n");
  static_cast<void>(send());
}

void TerminalSink::take_again() noexcept {
  const std::lock_guard lock(mutex_);
  given_back_ = false;
  anew_ = open_;
}

hal::Result<void> TerminalSink::close() {
  const std::lock_guard lock(mutex_);
  if (!open_) return {};
  open_ = false;
  put(plain);
  put(show_cursor);
  if (anything_drawn_ || line_begun_) put("\n");
  // Once more, for a terminal that is only slow.
  int tries = 2;
  const int why = out_.write(std::string_view(buffer_).substr(sent_, used_ - sent_), [&] { return tries-- > 0; });
  used_ = sent_ = 0;
  if (why == 0 || why == ETIMEDOUT) return {};
  return tl::unexpected(file_error(why, "terminal", "cannot be written"));
}

/// What the terminal takes at once; the rest waits for the next time.
hal::Result<void> TerminalSink::send() noexcept {
  while (sent_ < used_) {
    const ssize_t put_bytes = out_.write_now(std::string_view(buffer_).substr(sent_, used_ - sent_));
    if (put_bytes < 0) return tl::unexpected(file_error(static_cast<int>(-put_bytes), "terminal", "cannot be written"));
    if (put_bytes == 0) return {};
    sent_ += static_cast<std::size_t>(put_bytes);
  }
  used_ = sent_ = 0;
  return {};
}

}  // namespace compueye::firmware
