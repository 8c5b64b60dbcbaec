#pragma once

#include <cstdint>
#include <memory>

#include "firmware/supervisor/service_manager.hpp"

namespace compueye::firmware {

/// systemd behind NOTIFY_SOCKET, sd_notify(3): READY=1 with the first picture, WATCHDOG=1 by progress and
/// WATCHDOG=trigger in its absence. Never an error: what systemd does not take is as if nobody listened.
class SystemdNotifier final : public ServiceManager {
 public:
  SystemdNotifier() noexcept;

  [[nodiscard]] std::int64_t watchdog_ns() const noexcept override { return watchdog_ns_; }
  void starting(std::int64_t at_most_ns, std::string_view doing) noexcept override;
  void ready() noexcept override;
  void status(std::string_view line) noexcept override;
  void alive() noexcept override;
  void restart_me() noexcept override;
  void stopping() noexcept override;

 private:
  std::int64_t watchdog_ns_ = 0;
};

/// systemd where it started this program and waits for its word, otherwise nobody.
[[nodiscard]] std::unique_ptr<ServiceManager> service_manager_of_environment();
[[nodiscard]] bool run_by_service_manager() noexcept;

}  // namespace compueye::firmware
