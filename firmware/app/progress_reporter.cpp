#include "firmware/app/progress_reporter.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>
#include <utility>

#include "firmware/files/output_stream.hpp"
#include "firmware/text/number_text.hpp"
#include "firmware/text/words.hpp"

namespace compueye::firmware {
namespace {

constexpr std::size_t narrowest = 20;
constexpr std::size_t widest_bar = 40;
// An estimate from less than this of the work jumps about too much to be worth reading.
constexpr double least_share_for_eta = 0.01;

double share_of(double done, double total) noexcept {
  if (!(total > 0.0) || !std::isfinite(total) || std::isnan(done)) return -1.0;
  return std::clamp(done / total, 0.0, 1.0);
}

}  // namespace

ProgressStyle style_of_stderr() {
  ProgressStyle style;
  const char* term = std::getenv("TERM");
  style.terminal = isatty(STDERR_FILENO) == 1 && term != nullptr && std::string_view(term) != "dumb";
  winsize size{};
  if (style.terminal && ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) style.columns = size.ws_col;
  return style;
}

ProgressReporter::ProgressReporter(const hal::Clock& clock, ProgressStyle style, Write write)
    : clock_(clock), style_(style), write_(std::move(write)) {
  style_.columns = std::max(style_.columns, narrowest);
}

ProgressReporter::ProgressReporter(const hal::Clock& clock)
    : ProgressReporter(clock, style_of_stderr(),
                       // A terminal that takes nothing must not hold the work: what does not fit is not said.
                       [to = std::make_shared<OutputStream>(STDERR_FILENO)](std::string_view text) {
                         static_cast<void>(to->write_now(text));
                       }) {}

ProgressReporter::~ProgressReporter() {
  if (drawn_) write_("\n");
}

void ProgressReporter::update(std::string_view what, double done, double total) {
  now_ns_ = clock_.now_ns();
  if (!active_ || what != stage_) {
    finish();
    begin(what);
  }
  share_ = share_of(done, total);
  if (style_.terminal) {
    if (!drawn_ || share_ == 1.0 || now_ns_ - shown_ns_ >= style_.redraw_ns) draw();
    return;
  }
  const std::int64_t since = now_ns_ - shown_ns_;
  const bool far = share_ - printed_share_ >= style_.line_every_share - 1e-9;
  // The end of a stage is finish()'s to print.
  if (share_ < 1.0 && (since >= style_.line_every_ns || (far && since >= style_.line_gap_ns))) print_line();
}

void ProgressReporter::expect(std::string_view what, double seconds) {
  finish();
  write_(fmt::format("{}: about {}, by estimate\n", visible_text(what), duration(seconds)));
}

void ProgressReporter::finish() {
  if (!active_) return;
  now_ns_ = clock_.now_ns();
  active_ = false;
  if (style_.terminal) clear();
  if (now_ns_ - began_ns_ < style_.line_gap_ns) return;
  const std::string share = share_ < 0.0 ? std::string() : fmt::format("{:.0f} %, ", std::floor(share_ * 100.0));
  write_(fmt::format("{}: {}{}\n", what_, share, duration(elapsed_s())));
}

void ProgressReporter::begin(std::string_view what) {
  active_ = true;
  stage_ = what;
  what_ = visible_text(what);
  share_ = -1.0;
  printed_share_ = 0.0;
  began_ns_ = now_ns_;
  shown_ns_ = now_ns_;
}

double ProgressReporter::elapsed_s() const noexcept {
  return static_cast<double>(now_ns_ - began_ns_) * 1e-9;
}

std::string ProgressReporter::body(std::size_t bar_cells) const {
  if (share_ < 0.0) return duration(elapsed_s());
  std::string text;
  if (bar_cells > 0) {
    const auto full = static_cast<std::size_t>(share_ * static_cast<double>(bar_cells));
    text = "[" + std::string(full, '#') + std::string(bar_cells - full, '.') + "] ";
  }
  text += fmt::format("{:3.0f} %", std::floor(share_ * 100.0));
  if (share_ >= least_share_for_eta && share_ < 1.0 && now_ns_ > began_ns_) {
    text += ", " + duration(elapsed_s() * (1.0 - share_) / share_) + " left";
  }
  return text;
}

void ProgressReporter::draw() {
  // The last column stays free: a character there makes some terminals wrap.
  const std::size_t room = style_.columns - 1;
  const std::size_t plain = display_width(what_) + 2 + display_width(body(0));
  const std::size_t brackets = 3;
  const std::size_t cells = room > plain + brackets ? std::min(widest_bar, room - plain - brackets) : 0;
  std::string line = what_ + ": " + body(cells >= 5 ? cells : 0);
  if (display_width(line) > room) line = excerpt(line, room - 3);
  write_("\r" + line + "\x1b[K");
  drawn_ = true;
  shown_ns_ = now_ns_;
}

void ProgressReporter::print_line() {
  write_(what_ + ": " + body(0) + "\n");
  printed_share_ = std::max(share_, 0.0);
  shown_ns_ = now_ns_;
}

void ProgressReporter::clear() {
  if (drawn_) write_("\r\x1b[K");
  drawn_ = false;
}

}  // namespace compueye::firmware
