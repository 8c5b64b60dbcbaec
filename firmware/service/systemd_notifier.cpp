#include "firmware/service/systemd_notifier.hpp"

#include <systemd/sd-daemon.h>

#include <algorithm>
#include <cstdlib>

namespace compueye::firmware {
namespace {

constexpr int keep_environment = 0;

/// One line: a line end would begin another assignment.
int length_of_line(std::string_view text) noexcept {
  return static_cast<int>(std::min<std::size_t>(text.find_first_of("\n\r"), std::min<std::size_t>(text.size(), 400)));
}

}  // namespace

SystemdNotifier::SystemdNotifier() noexcept {
  std::uint64_t usec = 0;
  if (sd_watchdog_enabled(keep_environment, &usec) > 0) watchdog_ns_ = static_cast<std::int64_t>(usec) * 1000;
}

void SystemdNotifier::starting(std::int64_t at_most_ns, std::string_view doing) noexcept {
  sd_notifyf(keep_environment, "EXTEND_TIMEOUT_USEC=%lld\nSTATUS=%.*s", static_cast<long long>(at_most_ns / 1000),
             length_of_line(doing), doing.data());
}

void SystemdNotifier::ready() noexcept {
  sd_notify(keep_environment, "READY=1");
}

void SystemdNotifier::status(std::string_view line) noexcept {
  sd_notifyf(keep_environment, "STATUS=%.*s", length_of_line(line), line.data());
}

void SystemdNotifier::alive() noexcept {
  sd_notify(keep_environment, "WATCHDOG=1");
}

void SystemdNotifier::restart_me() noexcept {
  sd_notify(keep_environment, "WATCHDOG=trigger");
}

void SystemdNotifier::stopping() noexcept {
  sd_notify(keep_environment, "STOPPING=1");
}

bool run_by_service_manager() noexcept {
  const char* const socket = std::getenv("NOTIFY_SOCKET");
  return socket != nullptr && *socket != '\0';
}

std::unique_ptr<ServiceManager> service_manager_of_environment() {
  if (run_by_service_manager()) return std::make_unique<SystemdNotifier>();
  return std::make_unique<NoServiceManager>();
}

}  // namespace compueye::firmware
