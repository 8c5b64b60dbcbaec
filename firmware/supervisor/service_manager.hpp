#pragma once

#include <cstdint>
#include <string_view>

namespace compueye::firmware {

/// Whoever started the program and keeps it running. Every call is told at once or not at all: none waits.
class ServiceManager {
 public:
  ServiceManager() = default;
  ServiceManager(const ServiceManager&) = delete;
  ServiceManager& operator=(const ServiceManager&) = delete;
  virtual ~ServiceManager() = default;

  /// Within which alive() is wanted again, in ns; 0: nobody waits for it.
  [[nodiscard]] virtual std::int64_t watchdog_ns() const noexcept = 0;

  /// Still starting, and so for at most this long until it says so again.
  virtual void starting(std::int64_t at_most_ns, std::string_view doing) noexcept = 0;
  /// Pictures come.
  virtual void ready() noexcept = 0;
  /// How the run goes, in one line.
  virtual void status(std::string_view line) noexcept = 0;
  virtual void alive() noexcept = 0;
  /// Nothing but a restart will help.
  virtual void restart_me() noexcept = 0;
  virtual void stopping() noexcept = 0;
};

/// Nobody did: a person at a terminal, a script.
class NoServiceManager final : public ServiceManager {
 public:
  [[nodiscard]] std::int64_t watchdog_ns() const noexcept override { return 0; }
  void starting(std::int64_t /*at_most_ns*/, std::string_view /*doing*/) noexcept override {}
  void ready() noexcept override {}
  void status(std::string_view /*line*/) noexcept override {}
  void alive() noexcept override {}
  void restart_me() noexcept override {}
  void stopping() noexcept override {}
};

}  // namespace compueye::firmware
