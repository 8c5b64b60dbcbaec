#pragma once

#include <doctest/doctest.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <string>

namespace compueye::test {

/// As long as it lives.
class Environment {
 public:
  Environment(const char* name, const std::string& value) : name_(name) { ::setenv(name, value.c_str(), 1); }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;
  ~Environment() { ::unsetenv(name_); }

 private:
  const char* name_;
};

/// The other end of NOTIFY_SOCKET.
class NotifySocket {
 public:
  explicit NotifySocket(const std::string& path) : fd_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    REQUIRE(::bind(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
  }
  NotifySocket(const NotifySocket&) = delete;
  NotifySocket& operator=(const NotifySocket&) = delete;
  ~NotifySocket() { ::close(fd_); }
  /// The next message; waits for it, and gives up after a limit that only a failure meets: empty.
  [[nodiscard]] std::string heard(int limit_ms = 60'000) const {
    pollfd wanted{fd_, POLLIN, 0};
    if (::poll(&wanted, 1, limit_ms) != 1) return {};
    char text[1024];
    const ssize_t got = ::recv(fd_, text, sizeof text, 0);
    return got > 0 ? std::string(text, static_cast<std::size_t>(got)) : std::string();
  }

  /// Reads on until a message that begins so; whether it came.
  [[nodiscard]] bool hears(const std::string& beginning) const {
    for (;;) {
      const std::string message = heard();
      if (message.starts_with(beginning)) return true;
      if (message.empty()) return false;
    }
  }

 private:
  int fd_;
};

}  // namespace compueye::test
