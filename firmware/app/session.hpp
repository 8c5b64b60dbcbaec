#pragma once

#include <signal.h>  // NOLINT(modernize-deprecated-headers): sigset_t is POSIX, not C

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <cstdio>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "firmware/app/progress_reporter.hpp"
#include "firmware/text/figures.hpp"
#include "hal/clock.hpp"
#include "hal/result.hpp"
#include "recon/setup/factor.hpp"

namespace compueye::firmware {

/// Writes `text` and flushes. Errors: no_space or io when the file (stdout on a full disk, a closed pipe) refuses it;
/// `name` says which.
[[nodiscard]] hal::Result<void> print_text(const std::string& text, std::FILE* to = stdout,
                                           const std::string& name = "standard output");

/// What the process returns: 2 for a usage error, 1 for every other failure.
[[nodiscard]] int exit_code(const hal::Error& error) noexcept;

/// Writes "compueye: place: sentence" and returns exit_code(), so that main() can end with it. Control characters (a
/// file name may hold a line break or a terminal escape) become visible escapes, so that it is one line whatever it
/// quotes.
int print_error(const hal::Error& error, std::FILE* to = stderr);

/// What Ctrl-C (SIGINT), SIGTERM and SIGHUP do to a command.
enum class OnSignal : std::uint8_t {
  ends_the_process,  ///< at once
  /// The command is asked to end, and does so by itself with what it has. Repeating the signal changes nothing: being
  /// impatient must not leave half a file behind, nor spoil the exit code of a program on its way out.
  ends_in_order,
  /// The same for a command that computes once and writes at the end; but whatever takes longer than a grace time to
  /// notice (one very long frame, reading a huge file) is ended from here: partial files are removed, the sentence is
  /// printed and the process left.
  gives_up,
};

/// What a command has of the world around it: the clock, whether it was asked to stop, and the two streams on which it
/// speaks. One in a process, made in main() while that has a single thread.
class Session {
 public:
  Session() = default;
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
  ~Session();

  /// Before the command begins. Signals that the parent had ignored (nohup, a shell's background job) stay ignored.
  void begin(OnSignal on_signal, bool json);

  [[nodiscard]] hal::Clock& clock() noexcept { return clock_; }
  /// One object on standard output, and nothing else, whether the command succeeds or fails.
  [[nodiscard]] bool json() const noexcept { return json_; }

  // Stopping.

  /// For whoever asks while it works.
  [[nodiscard]] const std::atomic<bool>& stop_requested() const noexcept { return stop_requested_; }
  /// The error interrupted once a stop was requested.
  [[nodiscard]] hal::Result<void> check_stop() const;
  /// A file that is being written through AtomicFile: its partial file goes when the process is left from here.
  void guard_output(const std::string& target);
  /// A whole file that makes no sense without the rest.
  void guard_part(const std::string& file);
  /// The work is done and about to be published: from now on nothing stops it. Error interrupted when a stop came
  /// before.
  [[nodiscard]] hal::Result<void> seal();

  // Telling.

  /// Shows on stderr how far the work is; false once it should stop. For one thread at a time.
  [[nodiscard]] recon::Progress progress();
  /// Sums up the stage in work.
  void end_progress();
  /// A sentence beside the report, on stderr.
  void note(std::string_view sentence);
  /// The report of the command, which prints one only: as text at once, or with --json as one object when the command
  /// has ended, with a failure after it as its member "error". Error io or no_space when standard output refuses it.
  [[nodiscard]] hal::Result<void> print(Figures figures);
  /// What is text for people and programs alike.
  [[nodiscard]] hal::Result<void> print(const std::string& text) { return print_text(text); }
  /// Ends the command: its failure as a sentence on stderr and, with --json, as an object on stdout. What main()
  /// returns: 0, 1 (failed) or 2 (wrong usage).
  [[nodiscard]] int end(hal::Result<void> done);

 private:
  void watch();
  void end_watching();
  [[noreturn]] void leave();
  [[nodiscard]] hal::Result<void> print_json(const hal::Result<void>& done) const;

  hal::MonotonicClock clock_;
  bool json_ = false;
  std::optional<Figures> report_;  // to be printed at the end, with --json
  std::optional<ProgressReporter> reporter_;

  OnSignal on_signal_ = OnSignal::ends_the_process;
  sigset_t signals_{};
  std::atomic<bool> stop_requested_{false};
  std::mutex mutex_;
  std::condition_variable ended_changed_;
  bool ended_ = false;
  std::vector<std::string> outputs_;
  std::vector<std::string> parts_;
  std::thread thread_;
};

}  // namespace compueye::firmware
