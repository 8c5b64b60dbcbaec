#include "firmware/app/interrupt/interrupt_watch.hpp"

#include <pthread.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <string>
#include <system_error>

#include "firmware/app/report/error_report.hpp"

namespace compueye::firmware {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds grace{500};
constexpr int wake_signal = SIGUSR2;

hal::Error stopped() {
  return {hal::ErrorCode::interrupted, {}, "stopped before the work was complete, nothing was written"};
}

/// A signal that the parent had ignored (nohup, a shell's background job) stays ignored.
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

InterruptWatch::InterruptWatch() {
  sigemptyset(&signals_);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) add_unless_ignored(signals_, signal);
  sigaddset(&signals_, wake_signal);
  pthread_sigmask(SIG_BLOCK, &signals_, &before_);
  thread_ = std::thread([this] { watch(); });
}

InterruptWatch::~InterruptWatch() {
  end_watching();
  pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

hal::Result<void> InterruptWatch::check() const {
  if (requested()) return tl::unexpected(stopped());
  return {};
}

void InterruptWatch::guard_output(const fs::path& target) {
  const std::lock_guard lock(mutex_);
  outputs_.push_back(target);
}

void InterruptWatch::guard_part(const fs::path& file) {
  const std::lock_guard lock(mutex_);
  parts_.push_back(file);
}

hal::Result<void> InterruptWatch::finish() {
  end_watching();
  return check();
}

void InterruptWatch::end_watching() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  ended_changed_.notify_all();
  if (!thread_.joinable()) return;
  pthread_kill(thread_.native_handle(), wake_signal);
  thread_.join();
}

void InterruptWatch::watch() {
  for (;;) {
    int signal = 0;
    sigwait(&signals_, &signal);
    std::unique_lock lock(mutex_);
    if (ended_) return;
    if (signal == wake_signal) continue;
    requested_ = true;
    if (ended_changed_.wait_for(lock, grace, [this] { return ended_; })) return;
    leave();
  }
}

void InterruptWatch::leave() {
  for (const fs::path& each : outputs_) remove_partials(each);
  std::error_code ignored;
  for (const fs::path& each : parts_) fs::remove(each, ignored);
  // A progress line may still be open.
  if (isatty(STDERR_FILENO) == 1) std::fputc('\n', stderr);
  std::_Exit(print_error(stopped()));
}

}  // namespace compueye::firmware
