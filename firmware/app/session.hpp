#pragma once

#include <signal.h>  // NOLINT(modernize-deprecated-headers): sigset_t is POSIX, not C

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "firmware/app/progress_reporter.hpp"
#include "firmware/files/output_stream.hpp"
#include "firmware/text/figures.hpp"
#include "hal/clock.hpp"
#include "hal/result.hpp"
#include "recon/setup/factor.hpp"

namespace compueye::firmware {

/// Writes `text`, waiting for a reader as long as `go_on()`. Errors: no_space, io (a full disk, a closed pipe) or
/// timeout (nobody reads); `name` says which stream.
[[nodiscard]] hal::Result<void> print_text(const std::string& text, OutputStream& to,
                                           const std::function<bool()>& go_on,
                                           const std::string& name = "standard output");

/// What the process returns: 2 for a usage error, 3 where what was stored is no longer so (an eye that sees otherwise
/// than in its session), 1 for every other failure.
[[nodiscard]] int exit_code(const hal::Error& error) noexcept;

/// "compueye: place: sentence" and a line end. Control characters (a file name may hold a line break or a terminal
/// escape) become visible escapes, so that it is one line whatever it quotes.
[[nodiscard]] std::string error_line(const hal::Error& error);

/// What the first Ctrl-C (SIGINT), SIGTERM or SIGHUP does to a command. A second one ends any command at once, with
/// exit code 128 + its number; a repetition within `SignalLimits::same_request` is no second one.
enum class OnSignal : std::uint8_t {
  /// The command is asked to end, and does so by itself with what it has. What does not end within a limit (a reader
  /// that sleeps, a disk that hangs) is ended from here. Until it first tells its progress it has nothing, and gives
  /// up.
  ends_in_order,
  /// The same for a command that computes once and writes at the end, with a short limit: whatever takes longer than
  /// that to notice (one very long frame, reading a huge file) is left, and nothing is written.
  gives_up,
};

struct SignalLimits {
  std::chrono::milliseconds in_order{10'000};
  std::chrono::milliseconds giving_up{500};
  /// Who sends a signal to a process and to its group sends it twice, as timeout(1) does.
  std::chrono::milliseconds same_request{200};
};

/// Of syslog(3), for what Session tells.
inline constexpr int error_priority = 3, note_priority = 5, info_priority = 6;

/// Whoever has changed the terminal for a picture of its own. Both are called from another thread.
struct ScreenUser {
  std::function<void()> give_back;   ///< before the process stops (Ctrl-Z) or is left
  std::function<void()> take_again;  ///< when it goes on
};

/// What a command has of the world around it: the clock, whether it was asked to stop, and the two streams on which it
/// speaks. One in a process, made in main() while that has a single thread.
class Session {
 public:
  explicit Session(SignalLimits limits = {});
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
  ~Session();

  /// Before the command begins. Signals that the parent had ignored (nohup, a shell's background job) stay ignored.
  /// `stdout_owner` names the option that has standard output to itself, if any: the report as text then goes to
  /// stderr.
  void begin(OnSignal on_signal, bool json, std::string stdout_owner = {});

  [[nodiscard]] hal::Clock& clock() noexcept { return clock_; }
  /// One object on standard output, and nothing else, whether the command succeeds or fails.
  [[nodiscard]] bool json() const noexcept { return json_; }
  [[nodiscard]] const std::string& stdout_owner() const noexcept { return stdout_owner_; }

  // Stopping.

  /// For whoever asks while it works.
  [[nodiscard]] const std::atomic<bool>& stop_requested() const noexcept { return stop_requested_; }
  /// The error interrupted once a stop was requested.
  [[nodiscard]] hal::Result<void> check_stop() const;
  /// A whole file that makes no sense without the rest: it goes when the process is left from here, as do the partial
  /// files of AtomicFile.
  void guard_part(const std::string& file);
  /// The terminal is given back when the process is stopped or left from here; {}: nobody has it any more.
  void guard_screen(ScreenUser user);
  /// The work is done and about to be published: from now on it ends in order. Error interrupted when a stop came
  /// before.
  [[nodiscard]] hal::Result<void> seal();

  // Telling.

  /// Shows on stderr how far the work is; false once it should stop. For one thread at a time.
  [[nodiscard]] recon::Progress progress();
  /// Told what is worked on, each time it gets on; {}: nobody is. On the thread that shows its progress.
  void on_progress(std::function<void(std::string_view what)> told) { on_progress_ = std::move(told); }
  /// Sums up the stage in work.
  void end_progress();
  /// A line on stderr while the work goes on, if there is room for it; from any thread.
  /// `priority` of syslog(3) is for the journal, where stderr goes there.
  void say(std::string_view line, int priority = info_priority);
  /// A sentence beside the report, on stderr.
  void note(std::string_view sentence);
  /// The report of the command, which prints one only: as text at once, or with --json as one object when the command
  /// has ended, with a failure after it as its member "error". Error io or no_space when standard output refuses it.
  [[nodiscard]] hal::Result<void> print(Figures figures);
  /// What is text for people and programs alike.
  [[nodiscard]] hal::Result<void> print(const std::string& text);
  /// Ends the command: its failure as a sentence on stderr and, with --json, as an object on stdout. What main()
  /// returns: 0, 1 (failed) or 2 (wrong usage).
  [[nodiscard]] int end(hal::Result<void> done);

 private:
  void watch();
  void end_watching();
  [[nodiscard]] bool seen(int signal);
  [[noreturn]] void leave(int code, const hal::Error& why);
  [[nodiscard]] hal::Result<void> print_json(const hal::Result<void>& done);
  [[nodiscard]] std::function<bool()> patience();
  /// A whole line for stderr, at a priority where the journal reads it.
  [[nodiscard]] std::string line_of(int priority, std::string text) const;

  const SignalLimits limits_;
  hal::MonotonicClock clock_;
  bool json_ = false;
  OutputStream out_{1}, err_{2};
  const bool journal_;
  std::string stdout_owner_;
  std::optional<Figures> report_;  // to be printed at the end, with --json
  std::optional<ProgressReporter> reporter_;
  std::function<void(std::string_view)> on_progress_;

  OnSignal on_signal_ = OnSignal::gives_up;
  std::atomic<bool> working_{false};  ///< on what it would end with
  sigset_t signals_{};
  std::atomic<bool> stop_requested_{false};
  std::mutex mutex_;
  bool ended_ = false;
  std::optional<std::int64_t> asked_ns_;  // when the stop came
  std::vector<std::string> parts_;
  ScreenUser screen_;
  std::thread thread_;
};

}  // namespace compueye::firmware
