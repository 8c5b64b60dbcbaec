#include "firmware/app/session.hpp"

#include <pthread.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <system_error>
#include <utility>

#include "firmware/files/output_target.hpp"
#include "firmware/files/partial_file.hpp"
#include "firmware/service/journal.hpp"
#include "firmware/text/words.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

constexpr int wake_signal = SIGUSR2;
/// What the last words of a process may wait for a reader.
constexpr std::chrono::milliseconds last_words{1000};

hal::Error stopped() {
  return {hal::ErrorCode::interrupted, {}, "stopped before the work was complete, nothing was written"};
}

void add_unless_ignored(sigset_t& set, int signal) {
  struct sigaction now {};
  if (sigaction(signal, nullptr, &now) == 0 && now.sa_handler != SIG_IGN) sigaddset(&set, signal);
}

bool asks_to_stop(int signal) noexcept {
  return signal == SIGINT || signal == SIGTERM || signal == SIGHUP;
}

std::function<bool()> for_a_while(std::chrono::milliseconds limit) {
  return [until = std::chrono::steady_clock::now() + limit] { return std::chrono::steady_clock::now() < until; };
}

}  // namespace

hal::Result<void> print_text(const std::string& text, OutputStream& to, const std::function<bool()>& go_on,
                             const std::string& name) {
  const int cause = to.write(text, go_on);
  if (cause == 0) return {};
  const auto code = cause == ENOSPC      ? hal::ErrorCode::no_space
                    : cause == ETIMEDOUT ? hal::ErrorCode::timeout
                                         : hal::ErrorCode::io;
  return hal::fail(code, name,
                   "cannot write the report: " +
                       (cause == ETIMEDOUT ? std::string("nobody reads it") : std::generic_category().message(cause)));
}

int exit_code(const hal::Error& error) noexcept {
  switch (error.code) {
    case hal::ErrorCode::usage:
      return 2;
    case hal::ErrorCode::stale:
      return 3;
    default:
      return 1;
  }
}

std::string error_line(const hal::Error& error) {
  return "compueye: " + visible_text(error.text()) + "\n";
}

Session::Session(SignalLimits limits) : limits_(limits), journal_(is_journal(STDERR_FILENO)) {}

Session::~Session() {
  end_watching();
}

void Session::begin(OnSignal on_signal, bool json, std::string stdout_owner) {
  on_signal_ = on_signal;
  json_ = json;
  stdout_owner_ = std::move(stdout_owner);
  sigemptyset(&signals_);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGTSTP}) add_unless_ignored(signals_, signal);
  sigaddset(&signals_, SIGCONT);
  sigaddset(&signals_, wake_signal);
  // For good: a signal that comes while the program is on its way out must not spoil its exit code.
  pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
  thread_ = std::thread([this] { watch(); });
}

hal::Result<void> Session::check_stop() const {
  if (stop_requested_) return tl::unexpected(stopped());
  return {};
}

void Session::guard_part(const std::string& file) {
  const std::lock_guard lock(mutex_);
  parts_.push_back(file);
}

void Session::guard_screen(ScreenUser user) {
  const std::lock_guard lock(mutex_);
  screen_ = std::move(user);
}

hal::Result<void> Session::seal() {
  const std::lock_guard lock(mutex_);
  TRY(check_stop());
  on_signal_ = OnSignal::ends_in_order;
  working_ = true;
  return {};
}

void Session::end_watching() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  if (!thread_.joinable()) return;
  pthread_kill(thread_.native_handle(), wake_signal);
  thread_.join();
}

void Session::watch() {
  // Time is looked at this often, and not only when a signal comes.
  constexpr timespec tick{0, 50'000'000};
  for (bool asked = false;;) {
    int signal = 0;
    if (asked) {
      signal = sigtimedwait(&signals_, nullptr, &tick);
    } else {
      sigwait(&signals_, &signal);
    }
    const std::lock_guard lock(mutex_);
    if (ended_) return;
    asked = seen(signal);
  }
}

/// What a signal does, or its absence for a while; true once a stop was asked for. With the lock held.
bool Session::seen(int signal) {
  if (signal == SIGTSTP) {
    if (screen_.give_back) screen_.give_back();
    static_cast<void>(::kill(::getpid(), SIGSTOP));
  }
  if (signal == SIGCONT && screen_.take_again) screen_.take_again();
  const std::int64_t now_ns = clock_.now_ns();
  if (!asked_ns_) {
    if (!asks_to_stop(signal)) return false;
    asked_ns_ = now_ns;
    stop_requested_ = true;
    return true;
  }
  const std::chrono::nanoseconds since(now_ns - *asked_ns_);
  const bool in_order = on_signal_ == OnSignal::ends_in_order && working_.load(std::memory_order_relaxed);
  if (asks_to_stop(signal) && since >= limits_.same_request) {
    leave(128 + signal, in_order ? hal::Error{hal::ErrorCode::interrupted,
                                              {},
                                              "ended at once by a second signal; what was written so far stays"}
                                 : stopped());
  }
  if (since < (in_order ? limits_.in_order : limits_.giving_up)) return true;
  if (!in_order) leave(1, stopped());
  leave(1,
        {hal::ErrorCode::timeout,
         {},
         "was asked to stop and could not within " + std::to_string(limits_.in_order.count()) +
             " ms, because somebody who is written to takes nothing, or a disk hangs; what was written so far stays"});
}

void Session::leave(int code, const hal::Error& why) {
  remove_partials();
  std::error_code ignored;
  for (const std::string& each : parts_) std::filesystem::remove(each, ignored);
  if (screen_.give_back) screen_.give_back();
  const auto go_on = for_a_while(last_words / 4);
  // A progress line may still be open.
  if (isatty(STDERR_FILENO) == 1) static_cast<void>(err_.write_now("\n"));
  if (json_) static_cast<void>(print_text(json_text(Figures{{"error", figures_of(why)}}), out_, go_on));
  static_cast<void>(err_.write(line_of(error_priority, error_line(why)), go_on));
  std::_Exit(code);
}

recon::Progress Session::progress() {
  if (!reporter_) reporter_.emplace(clock_);
  return {[this](std::string_view what, double done, double total) {
            working_.store(true, std::memory_order_relaxed);
            reporter_->update(what, done, total);
            if (on_progress_) on_progress_(what);
            return !stop_requested_.load(std::memory_order_relaxed);
          },
          [this](std::string_view what, double seconds) { reporter_->expect(what, seconds); }};
}

void Session::end_progress() {
  if (reporter_) reporter_->finish();
}

/// A reader has as long as it likes, until the command is to end.
std::function<bool()> Session::patience() {
  return [this, last = std::optional<std::function<bool()>>()]() mutable {
    if (!stop_requested_) return true;
    if (!last) last = for_a_while(last_words);
    return (*last)();
  };
}

std::string Session::line_of(int priority, std::string text) const {
  return journal_ ? journal_prefix(priority) + text : text;
}

void Session::say(std::string_view line, int priority) {
  static_cast<void>(err_.write_now(line_of(priority, "compueye: " + visible_text(line) + "\n")));
}

void Session::note(std::string_view sentence) {
  static_cast<void>(
      err_.write(line_of(note_priority, "compueye: note: " + visible_text(sentence) + "\n"), for_a_while(last_words)));
}

hal::Result<void> Session::print(const std::string& text) {
  return print_text(text, out_, patience());
}

hal::Result<void> Session::print(Figures figures) {
  if (!json_) return print_text(figures.text(), stdout_owner_.empty() ? out_ : err_, patience());
  report_ = std::move(figures);
  return {};
}

hal::Result<void> Session::print_json(const hal::Result<void>& done) {
  if (done) return report_ ? print(json_text(*report_)) : hal::Result<void>{};
  return print(json_text(report_.value_or(Figures{}).add("error", figures_of(done.error()))));
}

int Session::end(hal::Result<void> done) {
  reporter_.reset();  // an error message begins on its own line
  if (json_) {
    // The first failure is the one to tell, even when stdout refuses this one too.
    if (auto printed = print_json(done); !printed && done) done = std::move(printed);
  }
  if (!done) static_cast<void>(err_.write(line_of(error_priority, error_line(done.error())), for_a_while(last_words)));
  end_watching();
  return done ? 0 : exit_code(done.error());
}

}  // namespace compueye::firmware
