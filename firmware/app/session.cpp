#include "firmware/app/session.hpp"

#include <pthread.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <utility>

#include "firmware/text/words.hpp"

namespace compueye::firmware {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds grace{500};
constexpr int wake_signal = SIGUSR2;

hal::Error stopped() {
  return {hal::ErrorCode::interrupted, {}, "stopped before the work was complete, nothing was written"};
}

void add_unless_ignored(sigset_t& set, int signal) {
  struct sigaction now {};
  if (sigaction(signal, nullptr, &now) == 0 && now.sa_handler != SIG_IGN) sigaddset(&set, signal);
}

/// AtomicFile's partial files of `target` that belong to this process.
void remove_partials(const fs::path& target) {
  std::error_code error;
  fs::path real = fs::weakly_canonical(target, error);
  if (error) real = target;
  const fs::path folder = real.has_parent_path() ? real.parent_path() : fs::path(".");
  const std::string begin = real.filename().string() + "." + std::to_string(getpid()) + "-";
  std::vector<fs::path> found;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    const std::string name = at->path().filename().string();
    if (name.starts_with(begin) && name.ends_with(".partial")) found.push_back(at->path());
  }
  for (const fs::path& each : found) fs::remove(each, error);
}

}  // namespace

hal::Result<void> print_text(const std::string& text, std::FILE* to, const std::string& name) {
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), to) == text.size() && std::fflush(to) == 0) return {};
  const int cause = errno;
  return hal::fail(cause == ENOSPC ? hal::ErrorCode::no_space : hal::ErrorCode::io, name,
                   "cannot write the report: " + std::generic_category().message(cause));
}

int exit_code(const hal::Error& error) noexcept {
  return error.code == hal::ErrorCode::usage ? 2 : 1;
}

int print_error(const hal::Error& error, std::FILE* to) {
  const std::string line = "compueye: " + visible_text(error.text()) + "\n";
  // Nothing sensible is left to do when even stderr refuses.
  if (std::fwrite(line.data(), 1, line.size(), to) == line.size()) std::fflush(to);
  return exit_code(error);
}

Session::~Session() {
  end_watching();
}

void Session::begin(OnSignal on_signal, bool json) {
  on_signal_ = on_signal;
  json_ = json;
  if (on_signal == OnSignal::ends_the_process) return;
  sigemptyset(&signals_);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) add_unless_ignored(signals_, signal);
  sigaddset(&signals_, wake_signal);
  // For good: a signal that comes while the program is on its way out must not spoil its exit code.
  pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
  thread_ = std::thread([this] { watch(); });
}

hal::Result<void> Session::check_stop() const {
  if (stop_requested_) return tl::unexpected(stopped());
  return {};
}

void Session::guard_output(const std::string& target) {
  const std::lock_guard lock(mutex_);
  outputs_.push_back(target);
}

void Session::guard_part(const std::string& file) {
  const std::lock_guard lock(mutex_);
  parts_.push_back(file);
}

hal::Result<void> Session::seal() {
  end_watching();
  return check_stop();
}

void Session::end_watching() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  ended_changed_.notify_all();
  if (!thread_.joinable()) return;
  pthread_kill(thread_.native_handle(), wake_signal);
  thread_.join();
}

void Session::watch() {
  for (;;) {
    int signal = 0;
    sigwait(&signals_, &signal);
    std::unique_lock lock(mutex_);
    if (ended_) return;
    if (signal == wake_signal) continue;
    stop_requested_ = true;
    if (on_signal_ == OnSignal::ends_in_order) continue;
    if (ended_changed_.wait_for(lock, grace, [this] { return ended_; })) return;
    leave();
  }
}

void Session::leave() {
  for (const std::string& each : outputs_) remove_partials(each);
  std::error_code ignored;
  for (const std::string& each : parts_) fs::remove(each, ignored);
  // A progress line may still be open.
  if (isatty(STDERR_FILENO) == 1) std::fputc('\n', stderr);
  if (json_) static_cast<void>(print_text(json_text(Figures{{"error", figures_of(stopped())}})));
  std::_Exit(print_error(stopped()));
}

recon::Progress Session::progress() {
  if (!reporter_) reporter_.emplace(clock_);
  return [this](std::string_view what, double done, double total) {
    reporter_->update(what, done, total);
    return !stop_requested_.load(std::memory_order_relaxed);
  };
}

void Session::end_progress() {
  if (reporter_) reporter_->finish();
}

void Session::note(std::string_view sentence) {
  const std::string line = "compueye: note: " + visible_text(sentence) + "\n";
  std::fputs(line.c_str(), stderr);
}

hal::Result<void> Session::print(Figures figures) {
  if (!json_) return print_text(figures.text());
  report_ = std::move(figures);
  return {};
}

hal::Result<void> Session::print_json(const hal::Result<void>& done) const {
  if (done) return report_ ? print_text(json_text(*report_)) : hal::Result<void>{};
  return print_text(json_text(report_.value_or(Figures{}).add("error", figures_of(done.error()))));
}

int Session::end(hal::Result<void> done) {
  end_watching();
  reporter_.reset();  // an error message begins on its own line
  if (json_) {
    // The first failure is the one to tell, even when stdout refuses this one too.
    if (auto printed = print_json(done); !printed && done) done = std::move(printed);
  }
  return done ? 0 : print_error(done.error());
}

}  // namespace compueye::firmware
