#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "hal/clock.hpp"

namespace compueye::firmware {

/// Where and how progress is shown.
struct ProgressStyle {
  bool terminal = false;                        ///< redraw one line; otherwise whole lines
  std::size_t columns = 80;                     ///< width of the terminal, >= 20
  std::int64_t redraw_ns = 100'000'000;         ///< terminal: at most one drawing in this time
  std::int64_t line_every_ns = 10'000'000'000;  ///< plain: a line at least this often while work goes on ...
  double line_every_share = 0.1;                ///< ... or after this share of the work, ...
  std::int64_t line_gap_ns = 1'000'000'000;     ///< ... but never sooner than this after the one before
};

/// What stderr is: a terminal (and TERM not "dumb") with its width, or a file or pipe.
[[nodiscard]] ProgressStyle style_of_stderr();

/// Tells a waiting person how far a long task is and when it will end. On a terminal one line with bar, percentage and
/// remaining time is redrawn; elsewhere (logs, CI) plain lines come rarely, and none for a stage shorter than
/// `line_gap_ns`. One thread calls update() and finish().
class ProgressReporter {
 public:
  using Write = std::function<void(std::string_view)>;

  /// `clock` must outlive the reporter.
  ProgressReporter(const hal::Clock& clock, ProgressStyle style, Write write);
  /// On stderr.
  explicit ProgressReporter(const hal::Clock& clock);
  ProgressReporter(const ProgressReporter&) = delete;
  ProgressReporter& operator=(const ProgressReporter&) = delete;
  /// Ends an unfinished line without a summary, so that an error message begins on its own line.
  ~ProgressReporter();

  /// `done` of `total` of stage `what`; a new `what` ends the stage before and begins another. `total` <= 0 or not
  /// finite: unknown, only the time elapsed is shown. `done` may go backwards; it is clipped to 0..total.
  void update(std::string_view what, double done, double total);

  /// Says at once, on a line of its own, that `what` will take about so many seconds, by estimate.
  void expect(std::string_view what, double seconds);

  /// Ends the current stage: "what: 100 %, 3.2 s" where a line is due. Idempotent.
  void finish();

 private:
  [[nodiscard]] std::string body(std::size_t bar_cells) const;
  [[nodiscard]] double elapsed_s() const noexcept;
  void draw();
  void print_line();
  void begin(std::string_view what);
  void clear();

  const hal::Clock& clock_;
  ProgressStyle style_;
  Write write_;
  bool active_ = false;
  bool drawn_ = false;   ///< a terminal line without its line end
  std::string stage_;    ///< as given
  std::string what_;     ///< as shown
  double share_ = -1.0;  ///< 0..1, negative = unknown
  double printed_share_ = 0.0;
  std::int64_t began_ns_ = 0;
  std::int64_t now_ns_ = 0;
  std::int64_t shown_ns_ = 0;
};

}  // namespace compueye::firmware
